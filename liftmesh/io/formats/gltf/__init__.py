"""glTF and GLB: what their JSON says is checked and walked through; trimesh decodes the rest."""
