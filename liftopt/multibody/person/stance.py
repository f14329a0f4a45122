"""How a person stands: two parallel feet that rest on the floor, heels down, and what of them bears."""

from __future__ import annotations

from liftopt.multibody.agent import Stance
from liftopt.multibody.person.anthropometry import HEEL_BEHIND_ANKLE, HIP_JOINT_SPREAD, dimension
from liftopt.multibody.person.bodies import whole_bodies
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.sources import Source

# With the whole foot on the floor nobody leans further than the first metatarsophalangeal joint, the ball of the foot.
FRONT_SOURCE = Source(
    "study of the Forward Functional Stability Indicator (abstract): with the feet flat, nobody's centre of pressure "
    "passes the first metatarsophalangeal joints; their distance from the heel is ANSUR II's 'balloffootlength'",
    "verified",
)
BACK_SOURCE = Source("the heel, behind the ankle by a quarter of the foot's length; chosen for this model", "estimate")
ASIDE_SOURCE = Source(
    "outer edges of two parallel feet below the hip joints (ANSUR II foot breadth; hip joints chosen for this model)",
    "estimate",
)
# A plan leaves room for what a body sways by even in quiet standing.
SWAY = 0.01
SWAY_SOURCE = Source("about what the centre of pressure wanders in quiet standing; chosen for this model", "estimate")
FRICTION = 0.5
FRICTION_SOURCE = Source(
    "Miller (1983), J Safety Res 14:77-82: a coefficient of friction of 0.5 is a reasonable standard for level floors",
    "verified",
)


def human_stance(subject: Subject) -> Stance:
    """Return how the subject stands, in the axes of the feet: origin below the ankles, X ahead, Y to the left.

    The soles bear from the heel to the ball of the foot, and from the outer edge of one foot to that of the other.
    """
    foot = dimension(subject, "footlength")
    back = -HEEL_BEHIND_ANKLE * foot
    ball = back + dimension(subject, "balloffootlength")
    aside = HIP_JOINT_SPREAD * dimension(subject, "hipbreadth") + dimension(subject, "footbreadthhorizontal") / 2.0
    feet = whole_bodies(subject)["feet"]
    return Stance(soles=((back, ball, aside),), friction=FRICTION, mass=feet.mass, p_base_com=feet.com, sway=SWAY)
