"""Declared machines: a page of Python becomes a machine.

`machine` is what a page makes, `equations` its formulas in every mode,
`words` lists of events over any set of contacts, `flights` and `problem` the equations of an orbit, `margins` what makes it
real, `stepper` and `simulation` the witness, `edits` and `crossing` the borders.
"""
