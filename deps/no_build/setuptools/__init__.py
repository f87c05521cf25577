"""Stands in for setuptools while pip downloads source packages: see build_meta.py."""
