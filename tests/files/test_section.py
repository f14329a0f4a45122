"""Checked sections of TOML files: oracle is what a reader of the message needs, key, value and what is allowed."""

from __future__ import annotations

from typing import Annotated, Literal

import pytest
from pydantic import Field

from liftopt.errors import InputError
from liftopt.files.entries import OrFree, entry, free_number, number, whole
from liftopt.files.frozen_table import FrozenTable
from liftopt.files.section import Section


class Wheel(Section):
    """A wheel."""

    radius: Annotated[float, number("radius", "m", 0.0, 1.0, open_low=True)]
    spokes: Annotated[int, whole("spokes", 3, 36)] = 32


class Cart(Section):
    """A cart."""

    version: Annotated[Literal[1], Field(alias="schema", description="version of the format")] = 1
    wheel: Wheel
    brake: Annotated[bool, entry("whether it has one")] = False
    colour: Annotated[Literal["red", "green"], entry("colour")] = "red"
    load: Annotated[float | None, free_number("load", "kg", 0.0, 100.0), OrFree] = None
    seats: FrozenTable[Annotated[float, number("seat", "m", 0.0, 1.0)]] = FrozenTable()


GIVEN = {"schema": 1, "wheel": {"radius": 0.3}, "load": "free", "seats": {"left": 0.4}}


def test_what_is_read_is_written_with_all_defaults() -> None:
    plain = Cart.checked(GIVEN).plain()
    assert plain == {
        "schema": 1, "wheel": {"radius": 0.3, "spokes": 32}, "brake": False, "colour": "red", "load": "free",
        "seats": {"left": 0.4},
    }  # fmt: skip
    assert Cart.checked(plain) == Cart.checked(GIVEN)
    assert hash(Cart.checked(plain)) == hash(Cart.checked(GIVEN))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"wheel": {"radius": 30}},
            "wheel.radius = 30: must be a number above 0 and at most 1 m (radius); in m it is 0.3",
        ),
        ({"wheel": {"radius": 0.0}}, "wheel.radius = 0.0: must be a number above 0"),
        ({"wheel": {}}, "wheel.radius: is missing; must be a number above 0 and at most 1 m (radius)"),
        ({"wheel": {"radius": 0.3, "spoke": 8}}, "wheel.spoke = 8: unknown key; did you mean spokes?"),
        (
            {"wheel": {"radius": 0.3, "spokes": 8.0}},
            "wheel.spokes = 8.0: must be a whole number from 3 to 36 (spokes); write 8",
        ),
        ({"wheel": 3}, "wheel = 3: must be a section with the keys radius, spokes (A wheel)"),
        ({"brake": "yes"}, "brake = 'yes': must be true or false (whether it has one); write true"),
        ({"colour": "gren"}, 'colour = \'gren\': must be "red" or "green" (colour); did you mean green?'),
        ({"load": "Free"}, "load = 'Free': must be a number from 0 to 100 kg, or \"free\" (load); write free"),
        ({"schema": 2}, "schema = 2: must be 1 (version of the format)"),
        ({"xyz": 2}, "xyz = 2: unknown key; known here: schema, wheel, brake, colour, load, seats"),
    ],
)
def test_a_refusal_is_one_line(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError) as caught:
        Cart.checked(GIVEN | change)
    assert str(caught.value).startswith(message)
    with pytest.raises(InputError) as inside:
        Cart.checked(GIVEN | change, "cart.")
    assert str(inside.value) == f"cart.{caught.value}"


def test_what_is_changed_is_checked_and_the_rest_stays() -> None:
    cart = Cart.checked(GIVEN)
    assert cart.changed(brake=True).brake
    assert cart.changed(brake=True).changed(brake=False) == cart
    with pytest.raises(InputError, match=r"^radius = 2\.0: must be"):
        cart.wheel.changed(radius=2.0)


def test_a_frozen_table_is_a_mapping_that_stays_and_tells_its_names() -> None:
    table = FrozenTable({"left": 1, "right": 2})
    assert (dict(table), len(table), list(table)) == ({"left": 1, "right": 2}, 2, ["left", "right"])
    assert table == FrozenTable({"left": 1, "right": 2})
    assert table != FrozenTable({"right": 2, "left": 1})  # the order tells who comes first
    with pytest.raises(KeyError, match="there are left, right; did you mean right"):
        table["rigth"]
