"""Models for other tools: C99, FMI, CasADi, MATLAB, Gazebo, ArduPilot. Computes no equation anew; writes no file."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
