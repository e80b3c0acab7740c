// Designs that several steps open.

/** A steel pinion on a POM wheel of a robot drive, above half of the torque that the wheel bears, with thicknesses by their spans. */
export const ROBOT_DRIVE = {
  method: "flexible",
  pair: {
    center_distance_mm: 40.65,
    driving: {
      tooth_count: 18,
      module_mm: 0.8,
      face_width_mm: 11.5,
      blank: { bore_radius_mm: 2.5 },
      profile_shift: 0.42,
      span_measurement: { teeth: 3, length_mm: 6.29 },
    },
    driven: {
      tooth_count: 83,
      module_mm: 0.8,
      face_width_mm: 10,
      blank: { bore_radius_mm: 8 },
      profile_shift: -0.12,
      material: { youngs_modulus_gpa: 2.8, poisson_ratio: 0.38, density_kg_m3: 1410 },
      span_measurement: { teeth: 10, length_mm: 23.25 },
    },
  },
  output_torques_n_m: [8.5],
};
