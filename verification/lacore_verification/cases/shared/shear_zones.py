r"""Coulomb loads of bodies that slide on a floor and may shear along it instead.

A von Mises body carries no shear stress above k. It slides where the friction mu t is below k, t
being the contact pressure. Where mu t is larger the floor holds the lowest layer, and the body
shears along it at k. The whole body moves either way, but the force that it needs is

    integral of min(mu t, k)

instead of mu times the normal force N. The pressure t is not determined by equilibrium, so that
the load is not unique: every equilibrium stress within yield whose shear stress on the floor is
min(mu t, k) is a Coulomb state together with the velocity of rigid sliding.

The pressure has a limit. Let a shear zone begin at the point s of the floor and x be a point in
it. The body is pushed to the right, so that the floor pulls it to the left by k. Virtual velocity,
of size 1 and with r as small as required:

          <---------------- layer        layer:  thickness r, from s to x, moves to the left
        .-------------------------+      fan:    about s, radius r, turns the motion downwards
      . fan|                      | r    wedge:  slides into the floor at the angle
    .------s======================x                atan(mu) to it
    wedge      mu t > k, shear k

On the floor before s, the traction (mu t, t) is perpendicular to the velocity of the wedge and does
no work. The floor under the layer gives the power k (x - s), which the top of the layer dissipates.
The fan turns by atan(mu) and dissipates 2 k r atan(mu). The wedge dissipates k r/mu. The stress at
the cut above x gives -sigma_x r, and sigma_x = -t on the floor, where the shear stress is k. The
power of the stresses is at most the dissipation, therefore

    t <= k (1/mu + 2 atan(mu)) = k T.

A zone that begins at the loaded end of the body has no wedge: the layer leaves through that end,
and t is at most the pressure there. With t <= k T, and as T > 1/mu, min(mu t, k) >= t/T everywhere
on the floor, and the force lies between N/T and mu N. If the pressure of the loaded end is larger
than k T, the force is more than k T h, and N/T does not reach that where N <= k h T^2, as here. The
stress is assumed to be continuous except along finitely many curves, and the floor to have finitely
many zones.

The lower limit holds for a body that moves as a whole. Whether a mechanism that strains the body
and slips on a part of the floor carries less has neither been found nor excluded.
"""

from math import atan


def least_friction(mu: float, pressure: float) -> float:
    """Compute the smallest mean shear stress on the floor of a body that slides as a whole.

    Args:
        mu: Friction coefficient.
        pressure: Mean contact pressure.

    Returns:
        ``pressure/T`` with ``T = 1/mu + 2 atan(mu)``, in the unit of the pressure.
    """
    return mu * pressure / (1 + 2 * mu * atan(mu))
