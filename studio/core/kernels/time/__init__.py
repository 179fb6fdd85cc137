"""What has to do with other moments: the edges of activations, easing where single frames jolt."""
