"""Inverse kinematics of arms and legs in closed form."""
