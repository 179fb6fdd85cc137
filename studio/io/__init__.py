"""Files: readers, writers, projects. Units and axes are converted once, here."""
