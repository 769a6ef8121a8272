"""Small programs with analytical solutions for all results of a backend."""

from lacore_verification.conformance.contact_programs import CONTACT
from lacore_verification.conformance.hardening_programs import HARDENING
from lacore_verification.conformance.hopeless_programs import HOPELESS
from lacore_verification.conformance.plastic_programs import PLASTIC
from lacore_verification.conformance.rigid_programs import RIGID
from lacore_verification.conformance.soil_programs import SOIL

WORKED = (*PLASTIC, *CONTACT, *HOPELESS, *RIGID, *HARDENING, *SOIL)
