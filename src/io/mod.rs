//! Floor 11: case files, formulas, errors with places, tables, pictures. Computes nothing.
