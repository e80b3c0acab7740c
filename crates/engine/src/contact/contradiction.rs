//! The checks of a solved contact against its own evidence: a result that contradicts it is none.

use super::MeshContact;

/// The largest penetration, as a part of the deflection, and the penetration in meters that is allowed at any load.
const MOST_PENETRATION: (f64, f64) = (0.1, 1e-8);

/// The largest deflection, as a part of the module: beyond it displacements are not small against the teeth.
const MOST_DEFLECTION: f64 = 0.25;

/// The largest difference between the moment of all forces about the driven axis and the torque, as a part of this.
const MOST_RESIDUAL: f64 = 1e-6;

/// A contradiction between a solution and its own evidence.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Contradiction {
    /// Flanks that carry load pass through each other.
    #[error("flanks penetrate each other by {depth} m, with a deflection of {deflection} m")]
    Penetration {
        /// The largest penetration, in meters.
        depth: f64,
        /// The lag of the driven gear because of the load, in meters.
        deflection: f64,
    },
    /// Teeth deflect by more than displacements may that count as small.
    #[error("the teeth deflect by {deflection} m, and by {most} m at most")]
    Deflection {
        /// The lag of the driven gear because of the load, in meters.
        deflection: f64,
        /// A quarter of the module, in meters.
        most: f64,
    },
    /// The forces do not carry the load.
    #[error("the forces differ from the load by {residual} of it")]
    Residual {
        /// |T_2 by the forces − T|/T.
        residual: f64,
    },
}

impl Contradiction {
    /// Refuses a `deflection` that is not small against teeth of this `module`.
    ///
    /// # Errors
    ///
    /// [`Contradiction::Deflection`].
    pub fn of_deflection(deflection: f64, module: f64) -> Result<(), Self> {
        let most = MOST_DEFLECTION * module;
        // A value that is not a number is not within any limit.
        if deflection.abs() <= most {
            Ok(())
        } else {
            Err(Self::Deflection { deflection, most })
        }
    }
}

impl MeshContact {
    /// The lag of the driven gear because of the load: δ less that at which the first flanks touch.
    pub fn deflection(&self) -> f64 {
        self.transmission_error - self.touch
    }

    /// Refuses a contact of teeth of this `module` that contradicts its own evidence.
    ///
    /// # Errors
    ///
    /// [`Contradiction`].
    pub fn check(&self, module: f64) -> Result<(), Contradiction> {
        let (depth, deflection, residual) = (self.penetration, self.deflection(), self.equilibrium);
        let (part, least) = MOST_PENETRATION;
        Contradiction::of_deflection(deflection, module)?;
        if depth > (part * deflection).max(least) {
            return Err(Contradiction::Penetration { depth, deflection });
        }
        if residual <= MOST_RESIDUAL {
            Ok(())
        } else {
            Err(Contradiction::Residual { residual })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10 µm of deflection on teeth of 2 mm, in balance and without penetration.
    fn sound() -> MeshContact {
        MeshContact {
            transmission_error: 13e-6,
            touch: 3e-6,
            ..MeshContact::default()
        }
    }

    fn refused(contact: &MeshContact) -> Option<Contradiction> {
        contact.check(2e-3).err()
    }

    #[test]
    fn a_contact_is_believed_up_to_each_of_its_limits_and_not_beyond() {
        let with = |change: fn(&mut MeshContact)| {
            let mut contact = sound();
            change(&mut contact);
            refused(&contact)
        };
        assert_eq!(refused(&sound()), None);
        assert_eq!(with(|of| of.penetration = 0.99e-6), None);
        assert!(matches!(
            with(|of| of.penetration = 1.01e-6),
            Some(Contradiction::Penetration { .. })
        ));
        // A light load deflects teeth by less than flanks are known to.
        assert_eq!(
            with(|of| (of.transmission_error, of.penetration) = (3.01e-6, 9.9e-9)),
            None
        );
        assert_eq!(with(|of| of.transmission_error = 502e-6), None);
        for delta in [504e-6, -498e-6, f64::NAN] {
            let contact = MeshContact {
                transmission_error: delta,
                ..sound()
            };
            assert!(matches!(
                refused(&contact),
                Some(Contradiction::Deflection { most, .. }) if most == 5e-4
            ));
        }
        assert_eq!(with(|of| of.equilibrium = 0.9e-6), None);
        for change in [
            (|of: &mut MeshContact| of.equilibrium = 1.1e-6) as fn(&mut MeshContact),
            |of| of.equilibrium = f64::NAN,
        ] {
            assert!(matches!(with(change), Some(Contradiction::Residual { .. })));
        }
    }
}
