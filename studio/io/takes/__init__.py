"""What a take is made of on its way out: a whole stage of takes, a character's own joints."""
