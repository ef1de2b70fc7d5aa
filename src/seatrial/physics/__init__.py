"""Ship models, their simulation, manoeuvres, sea states, hydrodynamics and feedback loops."""
