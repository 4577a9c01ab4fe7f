"""Problems and their parts: potentials, patches of parameters, and the files that describe them."""
