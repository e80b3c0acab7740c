//! A curve with its points between positions in its lists.

use super::between::BetweenDocument;
use super::curve::CurveDocument;
use super::stress::GearStressDocument;

impl CurveDocument {
    /// The curve with its points between positions in its lists; `None` if it has none.
    pub(super) fn with_points(mut self) -> Option<Self> {
        let BetweenDocument {
            mesh_position,
            driving_angle_deg,
            driven_angle_deg,
            transmission_error_um,
            mesh_stiffness_tangent_n_per_m,
            mesh_stiffness_secant_n_per_m,
            driving_torque_n_m,
            pairs_in_contact,
            peak_contact_pressure_mpa,
            load_shares,
            stress,
            face,
            rigid_blank_transmission_error_um,
        } = self.between.take()?;
        let order = Order::of(&self.mesh_position, &mesh_position);
        order.join(&mut self.mesh_position, mesh_position);
        order.join(&mut self.driving_angle_deg, driving_angle_deg);
        order.join(&mut self.driven_angle_deg, driven_angle_deg);
        order.join(&mut self.transmission_error_um, transmission_error_um);
        order.join(
            &mut self.mesh_stiffness_tangent_n_per_m,
            mesh_stiffness_tangent_n_per_m,
        );
        order.join(
            &mut self.mesh_stiffness_secant_n_per_m,
            mesh_stiffness_secant_n_per_m,
        );
        order.join(&mut self.driving_torque_n_m, driving_torque_n_m);
        order.join(&mut self.pairs_in_contact, pairs_in_contact);
        order.join(
            &mut self.peak_contact_pressure_mpa,
            peak_contact_pressure_mpa,
        );
        for (own, further) in self.load_shares.iter_mut().zip(load_shares) {
            order.join(&mut own.share, further.share);
        }
        if let (Some(own), Some(further)) = (&mut self.stress, stress) {
            order.join_stresses(&mut own.driving, further.driving);
            order.join_stresses(&mut own.driven, further.driven);
        }
        if let (Some(own), Some(further)) = (&mut self.face, face) {
            order.join(&mut own.load_n_per_mm, further.load_n_per_mm);
            order.join(&mut own.load_centroid_mm, further.load_centroid_mm);
        }
        if let (Some(own), Some(further)) =
            (&mut self.decomposition, rigid_blank_transmission_error_um)
        {
            order.join(&mut own.rigid_blank_transmission_error_um, further);
        }
        Some(self)
    }
}

/// The order of positions and points: true for a point.
struct Order(Vec<bool>);

impl Order {
    /// That of rising `positions` and `points`, the points first where both are equal.
    fn of(positions: &[f64], points: &[f64]) -> Self {
        let mut order = Vec::with_capacity(positions.len() + points.len());
        let mut points = points.iter().peekable();
        for position in positions {
            while points.next_if(|point| *point <= position).is_some() {
                order.push(true);
            }
            order.push(false);
        }
        order.extend(points.map(|_| true));
        Self(order)
    }

    /// Puts the values of the points, if it has any, into a list of those of the positions.
    fn join<T>(&self, own: &mut Vec<T>, points: Vec<T>) {
        if own.len() + points.len() != self.0.len() {
            return;
        }
        let mut points = points.into_iter();
        let mut positions = std::mem::take(own).into_iter();
        let next = |is_point: &bool| {
            if *is_point {
                points.next()
            } else {
                positions.next()
            }
        };
        own.extend(self.0.iter().filter_map(next));
    }

    fn join_stresses(&self, own: &mut GearStressDocument, points: GearStressDocument) {
        self.join(&mut own.root_mpa, points.root_mpa);
        self.join(&mut own.root_angle_deg, points.root_angle_deg);
        self.join(&mut own.root_z_mm, points.root_z_mm);
        self.join(&mut own.root_tension_mpa, points.root_tension_mpa);
        self.join(
            &mut own.root_tension_angle_deg,
            points.root_tension_angle_deg,
        );
        self.join(&mut own.root_tension_z_mm, points.root_tension_z_mm);
        self.join(&mut own.root_compression_mpa, points.root_compression_mpa);
        self.join(
            &mut own.root_compression_angle_deg,
            points.root_compression_angle_deg,
        );
        self.join(&mut own.root_compression_z_mm, points.root_compression_z_mm);
        self.join(&mut own.hole_mpa, points.hole_mpa);
        self.join(&mut own.hole_angle_deg, points.hole_angle_deg);
        self.join(&mut own.hole_z_mm, points.hole_z_mm);
    }
}
