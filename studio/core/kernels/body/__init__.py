"""Posing a body from channels, encoding it again, forward kinematics and skinning."""
