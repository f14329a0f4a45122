// Where the camera stands: presets that fit a part of the scene between the panels, and names above the figures.
"use strict";
function make_camera(viewer, data, element) {
  const camera = viewer.camera;
  camera.fov = 38;
  const controls = viewer.controls;
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const sum = (a, b, scale) => a.map((value, i) => value + scale * b[i]);
  const unit = (a) => a.map((value) => value / Math.hypot(...a));
  // The scene is turned to Y up: world (x, y, z) stands at (x, z, -y).
  const turned = ([x, y, z]) => [x, z, -y];

  // What each preset shows, from which side, and what it says of itself.
  const views = Object.fromEntries(data.views.map((view) => [view.name, view]));
  const presets = Object.keys(views);
  let chosen = null;

  function corners([low, high]) {
    return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => low.map((value, axis) => ((i >> axis) & 1 ? high[axis] : value)));
  }

  // Return target and distance such that a box is seen whole, between the panels above and below.
  function fit(box, from) {
    const right = unit(cross([-from[0], -from[1], -from[2]], [0, 0, 1]));
    const up = cross(from, right);
    const height = window.innerHeight, room = 0.04;
    // Names stand above heads, where these are near each other the one above the other.
    const names = data.labels.length ? 50 : 0;
    const top = Math.min(element("top").getBoundingClientRect().bottom + names, 0.45 * height);
    const bottom = Math.min(height - element("bar").getBoundingClientRect().top, 0.3 * height);
    const tall = Math.tan((camera.fov * Math.PI) / 360), wide = tall * camera.aspect;
    const middle = box[0].map((value, i) => (value + box[1][i]) / 2);
    const points = corners(box).map((corner) => {
      const at = sum(corner, middle, -1);
      return { x: dot(at, right), y: dot(at, up), near: dot(at, from) };
    });
    // The picture may be shifted: which shifts keep all corners between two edges, as shares of half the picture.
    function shifts(key, distance, tangent, least, most) {
      const far = points.map((point) => (distance - point.near) * tangent);
      const low = Math.max(...points.map((point, i) => point[key] - most * far[i]));
      const high = Math.min(...points.map((point, i) => point[key] - least * far[i]));
      return { low, high, middle: (low + high) / 2 };
    }
    const across = (distance) => shifts("x", distance, wide, -1 + room, 1 - room);
    const along = (distance) => shifts("y", distance, tall, -1 + (2 * bottom) / height + room, 1 - (2 * top) / height - room);
    const sees = (distance) => [across(distance), along(distance)].every((shift) => shift.low <= shift.high);
    let near = Math.max(...points.map((point) => point.near)) + 0.1, far = 100;
    for (let i = 0; i < 40; i += 1) {
      const distance = (near + far) / 2;
      if (sees(distance)) far = distance;
      else near = distance;
    }
    return [sum(sum(middle, right, across(far).middle), up, along(far).middle), far];
  }

  // Make everything see-through but some bodies; without these, all is solid.
  function see_through(solid) {
    for (const lift of data.lifts) {
      const bodies = viewer.scene_tree.find([...lift.root.split("/").filter((part) => part), "body"]);
      for (const [name, body] of Object.entries(bodies.children)) {
        body.object.traverse((object) => {
          if (!object.isMesh) return;
          const material = object.material;
          const own = (material.userData.own ??= { opacity: material.opacity, transparent: material.transparent });
          Object.assign(material, own, { depthWrite: !own.transparent });
          if (solid && !solid.includes(name)) {
            Object.assign(material, { opacity: 0.15 * own.opacity, transparent: true, depthWrite: false });
          }
          material.needsUpdate = true;
        });
      }
    }
  }

  function press(name) {
    for (const button of element("views").children) button.setAttribute("aria-pressed", String(button.textContent === name));
  }

  function look(name) {
    chosen = name;
    const from = unit(views[name].side);
    const [target, distance] = fit(views[name].box, from);
    camera.position.set(...turned(sum(target, from, distance)));
    controls.target.set(...turned(target));
    controls.update();
    see_through(views[name].solid);
    viewer.set_dirty();
    press(name);
    place_names();
  }

  // Names stand above the heads; where two would cover each other, the later one goes higher, and none lies half under
  // a panel.
  function place_names() {
    if (!data.labels.length) return;
    camera.updateMatrixWorld();
    const placed = [];
    const panels = ["facts", "views", "bar"].map((id) => element(id).getBoundingClientRect());
    [...element("names").children].forEach((name, i) => {
      const at = new MeshCat.THREE.Vector3(...turned(data.labels[i].at)).project(camera);
      const box = { width: name.offsetWidth, height: name.offsetHeight };
      const middle = ((at.x + 1) / 2) * window.innerWidth;
      // Near the edge it stays whole; a head that is out of the picture takes its name along.
      const inside = middle > 0 && middle < window.innerWidth;
      const left = middle - box.width / 2;
      box.left = inside ? Math.min(Math.max(left, 4), window.innerWidth - box.width - 4) : left;
      box.top = ((1 - at.y) / 2) * window.innerHeight - box.height;
      const covers = (other) => other.left < box.left + box.width + 4 && box.left < other.left + other.width + 4
        && Math.abs(other.top - box.top) < box.height + 2;
      for (let other; (other = placed.find(covers)); ) box.top = other.top - box.height - 3;
      placed.push(box);
      const under = panels.some((panel) => panel.left < box.left + box.width && box.left < panel.right
        && panel.top < box.top + box.height && box.top < panel.bottom);
      name.style.visibility = at.z < 1 && !under ? "visible" : "hidden";
      name.style.transform = `translate(${box.left.toFixed(1)}px, ${box.top.toFixed(1)}px)`;
    });
  }

  presets.forEach((name, i) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.title = `${views[name].title} (${i + 1})`;
    button.addEventListener("click", () => look(name));
    element("views").append(button);
  });
  controls.addEventListener("start", () => { chosen = null; press(null); });
  window.addEventListener("resize", () => { if (chosen) look(chosen); });
  return { look, place_names, presets };
}
