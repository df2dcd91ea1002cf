"""Measures the surfaces of segmented 3-D objects."""
