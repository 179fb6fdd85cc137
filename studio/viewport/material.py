"""Shading of surfaces: one light at the camera, and in the shader a sky and a soft rim light."""

import pyvista as pv

_SHADED = """//VTK::Light::Impl
  float skyward = dot(normalVCVSOutput, skyVC);
  float rim = pow(1.0 - clamp(normalVCVSOutput.z, 0.0, 1.0), 3.0);
  float glow = 0.10 + 0.10 * skyward;
  fragOutput0.rgb *= 0.80 + 0.20 * skyward;
  fragOutput0.rgb += diffuseColor * glow + rim * glow * vec3(0.80, 0.90, 1.0);
"""


def light_like_a_studio(plotter: pv.Plotter) -> None:
    """Add one light that moves with the camera, above it and to its left."""
    plotter.remove_all_lights()
    lamp = pv.Light(light_type="camera light", position=(-0.45, 0.75, 1.0), focal_point=(0, 0, 0), intensity=0.95)
    plotter.add_light(lamp)


class SkyShading:
    """Material of actors; ``turn`` updates the up direction in their shaders."""

    def __init__(self) -> None:
        self._actors: dict[int, pv.Actor] = {}

    def give(self, actor: pv.Actor) -> None:
        """Add the material to an actor: smooth and slightly shiny."""
        surface = actor.GetProperty()
        surface.SetAmbient(0.16)
        surface.SetDiffuse(0.80)
        surface.SetSpecular(0.20)
        surface.SetSpecularPower(28.0)
        surface.SetInterpolationToPhong()
        shader = actor.GetShaderProperty()
        shader.AddFragmentShaderReplacement("//VTK::Light::Impl", True, _SHADED, False)
        self._actors[id(actor)] = actor

    def take(self, actor: pv.Actor) -> None:
        """Forget an actor."""
        self._actors.pop(id(actor), None)

    def clear(self) -> None:
        """Forget all actors."""
        self._actors.clear()

    def turn(self, up: tuple[float, float, float]) -> None:
        """Set the stage's ``up`` direction in view coordinates (right, up, towards the viewer)."""
        for actor in self._actors.values():
            actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniform3f("skyVC", up)
