"""What is to be proved: potentials, patches of parameters, and the files that describe them."""
