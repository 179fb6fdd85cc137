"""Character: a build, the proportions applied to it, a colour and a skin."""

import re
from dataclasses import dataclass, field
from functools import cached_property

from studio.core.body.growth import KeyedProportions, animated_morphology
from studio.core.body.morphology import AnyMorphology, Morphology, Proportions
from studio.core.curves.tangents import LEFT_OUT_IF_DEFAULT
from studio.core.mesh.skin import Blending, SkinnedMesh, with_grip
from studio.core.mesh.volume import BodyVolume, fitted_volume


@dataclass(frozen=True)
class Character:
    """Character that performs motions: ``skin`` is bound to the measures ``build``, and ``colour`` is ``#RRGGBB``.

    Raises ValueError if the skin does not fit the build, or the colour is invalid.
    """

    name: str
    colour: str
    build: Morphology
    skin: SkinnedMesh
    proportions: Proportions | KeyedProportions = field(default_factory=Proportions)
    """Factors on the measures of the build, constant or keyed over time."""
    blending: Blending = Blending.LINEAR
    grip: float = 0.0
    """Shape of the hands, from open (-1) over at ease (0) to fists (1)."""
    tags: tuple[str, ...] = field(default=(), metadata=LEFT_OUT_IF_DEFAULT)
    """Words that the user gave it to find it in the library."""

    def __post_init__(self) -> None:
        if not re.fullmatch(r"#[0-9A-Fa-f]{6}", self.colour):
            raise ValueError(f"colour: #RRGGBB expected, not '{self.colour[:40]}'.")
        if not -1.0 <= self.grip <= 1.0:
            raise ValueError(f"grip: a number from -1 to 1 expected, not {self.grip}.")
        if not self.skin.fits_body(self.build.layout.segment_count):
            raise ValueError("skin: it is bound to segments that the build does not have.")

    @cached_property
    def morphology(self) -> Morphology:
        """Measures of the build with its proportions; for a growing body those of its first key."""
        keyed = self.proportions
        first = keyed.values[0] if isinstance(keyed, KeyedProportions) else keyed
        return first.applied_to(self.build)

    def body_over(self, begin: float, frame_rate: float, count: int) -> AnyMorphology:
        """Measures in ``count`` frames, the first at stage second ``begin``."""
        if isinstance(self.proportions, KeyedProportions):
            return animated_morphology(self.build, self.proportions, begin, frame_rate, count)
        return self.morphology

    def proportions_at(self, time: float) -> Proportions:
        """Factors on the build's measures at stage second ``time``."""
        keyed = self.proportions
        return keyed.proportions_at(time) if isinstance(keyed, KeyedProportions) else keyed

    @property
    def shown_skin(self) -> SkinnedMesh:
        """Skin with the hands shaped by ``grip``."""
        return with_grip(self.skin, self.grip)

    @cached_property
    def volume(self) -> BodyVolume:
        """Collision volume of the skin fitted to ``morphology``."""
        return fitted_volume(self.skin, self.build, self.morphology)
