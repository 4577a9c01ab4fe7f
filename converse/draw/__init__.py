"""Figures of proofs, portraits, tori and maps, by matplotlib (the extra "plot")."""
