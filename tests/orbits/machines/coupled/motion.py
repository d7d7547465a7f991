"""The coupled machine's motion between events by matrix exponential: forced oscillator and absorber, sin Psi and cos Psi as states."""

import numpy as np
from scipy.linalg import expm


def path(params, mode, psi, w, w_rate, v, v_rate, duration, count):
    """States (q1, q1', q2, q2', sin Psi, cos Psi, 1), shape (count + 1, 7), and accelerations q1'', q2''."""
    G, Omega, lam, eps, _, mu, g, chi, slope = params
    absorber = mode * mu * g * np.cos(slope) + g * np.sin(slope) if mode else 0.0
    matrix = np.zeros((7, 7))
    matrix[0, 1] = matrix[2, 3] = 1.0
    matrix[4, 5], matrix[5, 4] = Omega, -Omega
    force = np.array([-1.0, -eps * lam, 0.0, 0.0, eps * G, eps * G * chi * eps * lam * Omega, 0.0])
    matrix[1] = force if mode else force / (1.0 + eps)
    matrix[3] = 0.0 if mode else force / (1.0 + eps)
    matrix[1, 6] -= eps * absorber
    matrix[3, 6] += absorber
    bodies = np.array([v + eps * w, v_rate + eps * w_rate, v - w, v_rate - w_rate]) / (1.0 + eps)
    states = [np.array([*bodies, np.sin(psi), np.cos(psi), 1.0])]
    step = expm(matrix * duration / count)
    for _ in range(count):
        states.append(step @ states[-1])
    states = np.array(states)
    return states, states @ matrix[1], states @ matrix[3]
