"""Conformance checks for models, readers, estimators and optimisers of other packages.

Each check raises `ConformanceError`, an AssertionError whose sentence says what was violated, so that a test of another
package is one line: ``st.testing.check_model(model())``. The built-in ones pass the same checks.
"""

from seatrial._lazy import export_lazily

export_lazily(__name__)
