"""Performers among others: rows of clips, props, who follows whom."""
