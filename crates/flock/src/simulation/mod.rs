//! Simulation of schools that follow their leaders round obstacles.
