"""Small programs solved by hand: what a backend must find, number by number."""

from verification.conformance.contact_programs import CONTACT
from verification.conformance.hardening_programs import HARDENING
from verification.conformance.hopeless_programs import HOPELESS
from verification.conformance.plastic_programs import PLASTIC
from verification.conformance.rigid_programs import RIGID
from verification.conformance.soil_programs import SOIL

WORKED = (*PLASTIC, *CONTACT, *HOPELESS, *RIGID, *HARDENING, *SOIL)
