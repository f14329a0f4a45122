// Controls around the meshcat viewer: the page's own clock sets the time of the viewer's animation.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("lift-data").textContent);
  const element = (id) => document.getElementById(id);
  const notice = (text) => { element("notice").textContent = text; element("notice").hidden = false; };
  // Without a graphics card smooth edges and shadows cost four pictures out of five.
  function software_only() {
    const context = document.createElement("canvas").getContext("webgl");
    const info = context.getExtension("WEBGL_debug_renderer_info");
    const name = info ? context.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
    context.getExtension("WEBGL_lose_context")?.loseContext();
    return /swiftshader|llvmpipe|softpipe|software/i.test(name);
  }
  function plain_viewer() {
    const renderer = new MeshCat.THREE.WebGLRenderer({ antialias: false });
    element("meshcat-pane").append(renderer.domElement);
    return new MeshCat.Viewer(element("meshcat-pane"), true, renderer);
  }

  let viewer;
  try {
    viewer = software_only() ? plain_viewer() : new MeshCat.Viewer(element("meshcat-pane"));
  } catch (error) {
    notice("This browser cannot show 3D pictures: it has no WebGL.");
    return;
  }
  data.commands.forEach((command) => viewer.handle_command(command));
  viewer.handle_command(data.animation);
  set_shadows();
  // Active but at rest: the clock below sets each action's time.
  viewer.animator.actions.forEach((action) => action.play());
  document.body.classList.add("bare");

  const state = { time: 0, playing: false, speed: 1, last: null, frames: 0, seconds: 0 };

  // Shadows fall on the floor only, from the sun alone: soft ones on every surface cost more than all the rest.
  function set_shadows() {
    viewer.renderer.shadowMap.type = 1;
    viewer.scene.traverse((object) => {
      if (object.isMesh) object.receiveShadow = object.parent.name === "floor";
      if (!object.isDirectionalLight) return;
      const reach = 2.2 + Math.max(...data.views[0].box.map((corner) => Math.hypot(...corner))) / 2;
      Object.assign(object.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, far: 20 });
      object.shadow.mapSize.set(1024, 1024);
      object.shadow.bias = -0.002;
    });
  }

  // ---- time -----------------------------------------------------------------------------------------------------
  function at(lift, values) {
    const times = lift.time;
    const last = times.length - 1;
    const place = Math.min(Math.max(state.time / times[last], 0), 1) * last;
    const low = Math.min(Math.floor(place), last - 1);
    return values[low] + (place - low) * (values[low + 1] - values[low]);
  }

  function seek(time) {
    state.time = Math.min(Math.max(time, 0), data.duration);
    viewer.animator.seek(state.time);
    element("timeline").value = state.time;
    element("clock").textContent = `${state.time.toFixed(2)} s of ${data.duration.toFixed(2)} s`;
    data.lifts.forEach((lift, i) => {
      for (const who of Object.keys(lift.force)) {
        element(`force-${who}-${i}`).textContent = `${at(lift, lift.force[who]).toFixed(1)} N`;
      }
      element(`height-${i}`).textContent = `${at(lift, lift.height).toFixed(3)} m`;
      if (!lift.nearest) return;
      const frame = Math.round(Math.min(Math.max(state.time / lift.time.at(-1), 0), 1) * (lift.time.length - 1));
      const apart = 1000 * lift.nearest.distance[frame];
      element(`nearest-${i}`).textContent = `${Math.abs(apart).toFixed(0)} mm ${apart < 0 ? "deep" : "apart"}`;
      element(`pair-${i}`).textContent = lift.nearest.pairs[lift.nearest.pair[frame]];
    });
  }

  function play(on) {
    if (on && state.time >= data.duration) seek(0);
    state.playing = on;
    state.last = null;
    state.frames = state.seconds = 0;
    element("play").innerHTML = on ? "&#10074;&#10074;" : "&#9654;";
  }

  function tick(now) {
    if (state.playing) {
      if (state.last !== null) {
        const passed = (now - state.last) / 1000;
        state.frames += 1;
        state.seconds += passed;
        // A tab that was hidden for long goes on where it stopped.
        let next = state.time + Math.min(passed, 0.25) * state.speed;
        if (next >= data.duration) {
          if (!element("repeat").checked) play(false);
          else if (state.time < data.duration) next = data.duration;
          else next = 0;
        }
        seek(next);
      }
      state.last = now;
    }
    view.place_names();
    requestAnimationFrame(tick);
  }

  // ---- what is written beside the picture -----------------------------------------------------------------------
  const object_colour = "#c7995f";
  function add(parent, kind, text, id) {
    const child = document.createElement(kind);
    child.textContent = text;
    if (id) child.id = id;
    parent.append(child);
    return child;
  }
  const table = add(element("facts"), "table", "");
  const heads = add(table, "tr", "");
  add(heads, "th", "");
  const called = (lift) => lift.name + (lift.ghost ? " (ghost)" : "");
  function chip(parent, colour) {
    const mark = document.createElement("span");
    mark.className = "chip";
    mark.style.background = colour;
    parent.prepend(mark);
  }
  data.lifts.forEach((lift) => {
    const head = add(heads, "th", called(lift));
    if (data.lifts.length < 2) return;
    chip(head, lift.colour);
  });
  data.labels.forEach((label) => {
    const name = add(element("names"), "div", label.text);
    name.className = "name";
    chip(name, label.colour);
  });
  function row(colour, text, key) {
    const line = add(table, "tr", "");
    const name = add(line, "td", text);
    const mark = document.createElement("span");
    mark.className = "key";
    mark.style.background = colour;
    name.prepend(mark);
    data.lifts.forEach((lift, i) => add(line, "td", "", `${key}-${i}`));
    return line;
  }
  data.hands.forEach((hand) => row(hand.colour, `force of ${hand.who}`, `force-${hand.name}`));
  row(object_colour, `height of the ${data.object}'s centre`, "height");
  if (data.lifts.some((lift) => lift.nearest)) {
    row(data.nearest_colour, "nearest two bodies", "nearest").className = data.lifts.length > 1 ? "spare" : "";
    data.lifts.forEach((lift, i) => {
      const line = add(table, "tr", "");
      add(line, "td", "", `pair-${i}`).colSpan = data.lifts.length + 1;
      line.className = "pair";
      line.hidden = data.lifts.length > 1;
    });
  }
  data.lifts.filter((lift) => !lift.solved).forEach((lift) => {
    add(element("facts"), "p", `${lift.name} is not a verified solution: ${lift.status}`).className = "bad";
  });
  const scale = document.createElement("small");
  scale.textContent = `arrows: force of each hand on the ${data.object}, 10 N is ${(1000 * data.metres_per_newton).toFixed(0)} cm`;
  element("facts").append(scale);

  // ---- camera and names -----------------------------------------------------------------------------------------
  const view = make_camera(viewer, data, element);
  const { look, presets } = view;

  // ---- controls -------------------------------------------------------------------------------------------------
  element("timeline").max = data.duration;
  element("timeline").addEventListener("input", (event) => { play(false); seek(Number(event.target.value)); });
  element("play").addEventListener("click", () => play(!state.playing));
  element("speed").addEventListener("change", (event) => { state.speed = Number(event.target.value); });
  function show(name, visible) {
    for (const lift of data.lifts) {
      viewer.handle_command({ type: "set_property", path: `${lift.root}/${name}`, property: "visible", value: visible });
    }
  }
  element("forces").addEventListener("change", (event) => show("force", event.target.checked));
  element("paths").addEventListener("change", (event) => show("path", event.target.checked));
  element("nearest").addEventListener("change", (event) => show("nearest", event.target.checked));
  element("tree").addEventListener("change", (event) => {
    document.body.classList.toggle("bare", !event.target.checked);
    if (event.target.checked) viewer.gui.open();
  });
  window.addEventListener("keydown", (event) => {
    if (["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName)) return;
    const step = event.shiftKey ? 0.1 : 0.02;
    if (event.key === " ") play(!state.playing);
    else if (event.key === "ArrowLeft") { play(false); seek(state.time - step); }
    else if (event.key === "ArrowRight") { play(false); seek(state.time + step); }
    else if (event.key === "Home") seek(0);
    else if (event.key === "End") { play(false); seek(data.duration); }
    else if (Number(event.key) >= 1 && Number(event.key) <= presets.length) look(presets[Number(event.key) - 1]);
    else return;
    event.preventDefault();
  });

  viewer.set_3d_pane_size();
  look("three-quarter");
  seek(0);
  viewer.render();
  requestAnimationFrame(tick);

  // Where a node of the scene tree stands in the world (4 x 4 by columns), for tests and for the curious.
  function placement(path) {
    let node = viewer.scene_tree;
    for (const name of path.split("/").filter((part) => part)) {
      node = node.children[name];
      if (node === undefined) return null;
    }
    viewer.scene.updateMatrixWorld(true);
    const from_scene = viewer.scene.matrixWorld.clone().invert();
    return from_scene.multiply(node.object.matrixWorld).elements.slice();
  }
  window.liftopt = { viewer, state, seek, play, look, placement, data, presets, ready: true,
                     first_picture: performance.now() };
})();
