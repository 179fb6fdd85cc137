"""What stands: feet, hands, knees, and the ground under them."""
