"""Faults made on purpose: spoilt scene files, damaged stores, runs that are killed."""
