"""What makes a subject is checked by name."""

from __future__ import annotations

import pytest

from liftopt.errors import InputError
from liftopt.multibody.person.subject import Subject


@pytest.mark.parametrize(
    ("key", "given"),
    [
        ("human.stature", (1.19, 75.0, "male")),
        ("human.stature", (175.0, 75.0, "male")),
        ("human.stature", (float("nan"), 75.0, "male")),
        ("human.stature", ("1.75", 75.0, "male")),
        ("human.mass", (1.75, 29.9, "male")),
        ("human.mass", (1.75, float("inf"), "male")),
        ("human.mass", (1.75, True, "male")),
        ("human.sex", (1.75, 75.0, "Male")),
        ("human.sex", (1.75, 75.0, None)),
    ],
)
def test_refuses_by_name(key, given):
    with pytest.raises(InputError) as error:
        Subject(*given)
    assert error.value.key == key
    assert str(error.value).startswith(f"{key} = ")


def test_takes_whole_numbers():
    assert Subject(2, 75, "female").stature == 2
