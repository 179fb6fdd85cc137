"""Measures the studio as a whole: speed, quality, growth, start-up, beside papers and peers. Not shipped."""

from studio.startup.process import prepare_process

prepare_process()  # numba reads the name of its cache folder once, when it is imported
