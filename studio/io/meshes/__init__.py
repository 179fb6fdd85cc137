"""Readers of meshes: points and triangles of a file, every size and index checked against its content.

They are our own and in Python, because a reader in C++ ends the whole process over an index that is out of range.
"""
