"""The commands converse, converse-map and converse-orbits; converse-check is converse.check."""
