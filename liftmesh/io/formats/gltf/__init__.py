"""glTF and GLB: what their JSON says is checked and walked through; NumPy reads the numbers."""
