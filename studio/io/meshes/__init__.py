"""Readers of mesh files: points and triangles, with every size and index checked against the content.

They are our own and in Python, because a reader in C++ ends the whole process over an index that is out of range.
"""
