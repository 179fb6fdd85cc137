"""glTF 2.0, GLB and VRM: characters and captures read, takes and stages written."""
