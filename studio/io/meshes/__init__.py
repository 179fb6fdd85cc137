"""Readers of meshes: points and triangles as they stand in a file, every size and index checked against what is there.

They are ours and in Python on purpose: a reader in C++ ends the whole process over an index that is out of range.
"""
