"""H-Anim characters: VRML97 and X3D, the classic and the XML encoding."""
