"""The commands converse, converse-map, converse-orbits and converse-tori; converse-check is
converse.check."""
