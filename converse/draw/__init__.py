"""Figures of proofs and of maps: PostScript, or what matplotlib writes (the extra "plot")."""
