"""Where the methods of results are that need more than the result does: figures, reports, files and
searches.  The rooms below call them by storage.methods.provided(), and import nothing upwards."""

from .storage import methods

methods.HOMES.update({
    "SymplecticMap.read": "model.inputs.read_input",
    "SymplecticMap.portrait": "orbits.portrait.portrait",
    "Proof.load": "prover.proof_file.proof_of",
    "Proof.save": "prover.proof_file.text_of",
    "Proof.plot": "draw.plot.page",
    "Portrait.plot": "draw.portrait_figure.draw",
    "Diagram.plot": "draw.diagram_figure.draw",
    "Torus.load": "tori.certificate.read",
    "Torus.save": "tori.certificate.text",
    "Torus.plot": "draw.torus_figure.draw",
    "ProvedTorus.plot": "draw.torus_figure.draw",
    "ProvedTorus.report": "tori.report.verdict",
    "PeriodicOrbit.save": "orbits.points.save",
    "PeriodicOrbit.plot": "orbits.pictures.figure",
    "PeriodicOrbit.report": "orbits.report.of_state",
    "PeriodicOrbit.minimax": "orbits.minimax.minimax",
    "Family.plot": "orbits.pictures.family_plot",
    "Family.report": "orbits.report.of_family",
    "Pair.prove": "orbits.proved_pair.prove_pair",
})
