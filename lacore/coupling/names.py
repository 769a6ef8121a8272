"""Names of the coupling loops (T13, T14), for help texts that load none of them."""

COUPLINGS = (
    "certified",
    "reaction",
    "shift",
    "kappa",
    "associated",
    "frictionless",
    "stick",
    "davis",
)
