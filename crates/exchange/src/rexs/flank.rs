//! Modifications of the loaded flanks of a gear: their profiles and their leads.

use serde_json::{Value, json};

use super::content::Component;
use super::gear::{DIGITS, Gear, SAME, needed};
use super::own;
use super::unit::{MM, um_of_mm};
use crate::significant;

/// How the attributes of a relief are called, in the model and in a submission.
pub(super) struct ReliefNames {
    pub(super) kind: &'static str,
    pub(super) depth: &'static str,
    pub(super) diameter: &'static str,
    pub(super) length: &'static str,
    pub(super) roll_length: &'static str,
}

pub(super) const TIP: ReliefNames = ReliefNames {
    kind: "tip_relief",
    depth: "tip_relief_depth",
    diameter: "tip_relief_datum_diameter",
    length: "tip_relief_datum_length",
    roll_length: "roll_length_from_tip_mm",
};

pub(super) const ROOT: ReliefNames = ReliefNames {
    kind: "root_relief",
    depth: "root_relief_depth",
    diameter: "root_relief_datum_diameter",
    length: "root_relief_datum_length",
    roll_length: "roll_length_from_form_mm",
};

/// Components that a flank refers to and that take nothing off it.
const BESIDE: [&str; 5] = [
    "material",
    "lubricant",
    "point_list",
    "gear_flank_data_set",
    "assembly_group",
];

/// The words at either end of a face.
const ENDS: [&str; 2] = ["datum_face", "non_datum_face"];

impl<'a> Gear<'a> {
    /// The modifications of the loaded flanks, tip reliefs first.
    pub(super) fn modifications(&self, pointer: &str) -> Option<Vec<Value>> {
        let first = self.of_loaded(
            |flank| self.modifications_of(flank),
            "Its flanks are modified differently",
        )?;
        for (i, modification) in first.iter().enumerate() {
            // The first tip relief has a field of its own.
            let short = first[0]["kind"] == "tip_relief";
            let field = match i {
                0 if short => format!("{pointer}/tip_relief"),
                i => format!("{pointer}/profile_modifications/{}", i - usize::from(short)),
            };
            let kind = modification["kind"].as_str().unwrap_or_default();
            let flank = self.loaded.first()?;
            self.reading.from(field, flank, &format!("its {kind}"));
        }
        Some(first)
    }

    /// The modifications of the leads of the loaded flanks.
    pub(super) fn leads(&self) -> Option<Vec<Value>> {
        self.of_loaded(
            |flank| self.leads_of(flank),
            "The leads of its flanks are modified differently",
        )
    }

    /// The modifications by `of_flank` of the loaded flanks, which have to be the same.
    fn of_loaded(
        &self,
        of_flank: impl Fn(&'a Component) -> Option<Vec<Value>>,
        unlike: &str,
    ) -> Option<Vec<Value>> {
        let of_each = self.loaded.iter().map(|flank| of_flank(flank));
        let mut of_each = of_each.collect::<Option<Vec<_>>>()?.into_iter();
        let first = of_each.next().unwrap_or_default();
        if of_each.any(|other| other != first) {
            let detail = format!(
                "{unlike}, and no loaded_tooth_flank of a cylindrical_stage_gear_data says which is loaded. Choose by --flank left or --flank right, or in a request by flank."
            );
            self.reading.wrong(self.gear.place(), detail);
            return None;
        }
        Some(first)
    }

    /// Components that `flank` refers to.
    fn parts_of(&self, flank: &'a Component) -> Vec<&'a Component> {
        let model = self.reading.model;
        model.related("reference", ("origin", flank), "referenced")
    }

    fn modifications_of(&self, flank: &'a Component) -> Option<Vec<Value>> {
        let parts = self.parts_of(flank);
        let of_kind =
            |kind: &'static str| parts.iter().copied().filter(move |part| part.kind == kind);
        let mut modifications = Vec::new();
        for tip in of_kind("tip_relief") {
            modifications.push(self.relief(tip, &TIP)?);
        }
        for root in of_kind("root_relief") {
            modifications.push(self.relief(root, &ROOT)?);
        }
        for crowning in of_kind("profile_crowning") {
            modifications.extend(self.crowning(crowning)?);
        }
        for slope in of_kind("profile_slope") {
            modifications.extend(self.slope(slope)?);
        }
        let known = |part: &Component| {
            let of_lead = part.kind.starts_with("helix_") && part.kind != "helix_deviation";
            let of_lead = of_lead || part.kind.starts_with("end_relief_");
            let of_profile = [TIP.kind, ROOT.kind, "profile_crowning", "profile_slope"];
            of_lead || of_profile.contains(&part.kind.as_str())
        };
        let modifying = parts
            .iter()
            .filter(|part| !BESIDE.contains(&part.kind.as_str()) && !part.kind.ends_with("_tool"));
        let modifying: Vec<&Component> = modifying.copied().collect();
        let unknown = modifying.iter().filter(|part| !known(part));
        let unknown = unknown.filter(|part| !self.takes_nothing_off(part)).count();
        let exclusive = modifying.iter().filter(|part| self.excludes_others(part));
        if unknown > 0 || (modifying.len() > 1 && exclusive.count() > 0) {
            return None;
        }
        let deviating = "topographical_deviation_amounts";
        if flank.attribute(deviating).is_some() {
            let detail = "A flank that deviates over its whole surface is not computed.";
            self.reading.wrong(flank.place_of(deviating), detail);
            return None;
        }
        match self.reading.json(flank, own::TABLES) {
            Some(Value::Array(tables)) => modifications.extend(tables),
            Some(_) => {
                let detail = "A list of profile tables is expected, as a submission has them.";
                self.reading.wrong(flank.place_of(own::TABLES), detail);
            }
            None => {}
        }
        Some(modifications)
    }

    /// True if a modification of an unknown kind has no amount; otherwise a fault, because without it another flank would be computed.
    fn takes_nothing_off(&self, part: &'a Component) -> bool {
        let amount = part.attributes.iter().find(|attribute| {
            let id = &attribute.id;
            id.contains("depth") || id.contains("amount") || *id == part.kind
        });
        let id = amount.map(|amount| amount.id.as_str());
        let none = id.and_then(|id| part.attribute(id)?.number(MM).ok()) == Some(0.0);
        if !none {
            let place = id.map_or_else(|| part.place(), |id| part.place_of(id));
            let detail = format!(
                "A modification of the kind {} is not known here, and without it the loaded flank would be another one. Known are tip_relief, root_relief, profile_crowning, profile_slope, helix_crowning, helix_slope, and end reliefs that are the same at both ends.",
                part.kind
            );
            self.reading.wrong(place, detail);
        }
        none
    }

    /// True if a modification is declared as exclusive, which is a fault.
    fn excludes_others(&self, part: &'a Component) -> bool {
        let name = "is_additive_modification";
        let exclusive = self.reading.choice(part, name, &["true", "false"]) == Some("false");
        if exclusive {
            let detail = "It is not to be added to the others of its flank; here they add up.";
            self.reading.wrong(part.place_of(name), detail);
        }
        exclusive
    }

    fn leads_of(&self, flank: &'a Component) -> Option<Vec<Value>> {
        let reading = self.reading;
        let parts = self.parts_of(flank);
        let mut leads = Vec::new();
        for part in &parts {
            match part.kind.as_str() {
                "helix_crowning" => leads.push(self.helix_crowning(part)?),
                "helix_slope" => leads.extend(self.helix_slope(part)?),
                _ => {}
            }
        }
        leads.extend(self.end_reliefs(&parts)?);
        match reading.json(flank, own::LEADS) {
            Some(Value::Array(others)) => leads.extend(others),
            Some(_) => {
                let detail = "A list of lead modifications is expected, as a submission has them.";
                reading.wrong(flank.place_of(own::LEADS), detail);
            }
            None => {}
        }
        Some(leads)
    }

    /// The reliefs at both ends of the face, if there are some. Which end is which depends on the sense in which the gears turn, which
    /// a model does not say, so that only those are taken that are the same at both.
    fn end_reliefs(&self, parts: &[&'a Component]) -> Option<Option<Value>> {
        let reading = self.reading;
        let mut at_ends = Vec::new();
        for end in ENDS {
            let kind = format!("end_relief_{end}");
            for part in parts.iter().filter(|part| part.kind == kind) {
                let depth = format!("end_relief_depth_{end}");
                let amount = needed(reading, part, &depth, MM)?;
                if amount == 0.0 {
                    continue;
                }
                let length = needed(reading, part, &format!("end_relief_length_{end}"), MM)?;
                let said = self.shape(part, &["linear"])?;
                self.refuse_transition(part)?;
                let reference = format!("end_relief_evaluation_reference_{end}");
                if reading
                    .number(part, &reference, MM)
                    .is_some_and(|at| at != 0.0)
                {
                    let detail = "The depth of an end relief is that at the end of the face here.";
                    reading.wrong(part.place_of(&reference), detail);
                    return None;
                }
                at_ends.push((end, [amount, length], said, *part, depth));
            }
        }
        match at_ends.as_slice() {
            [] => Some(None),
            [(one, at_one, ..), (other, at_other, ..)] if one != other && at_one == at_other => {
                let [amount, length] = *at_one;
                Some(Some(json!({
                    "kind": "end_relief", "amount_um": um_of_mm(amount), "length_mm": length, "side": "both",
                })))
            }
            [(.., part, depth), ..] => {
                let detail = "An end relief is taken if the face has the same at both ends; at one alone it depends on the sense in which the gears turn at which end it is.";
                reading.wrong(part.place_of(depth), detail);
                None
            }
        }
    }

    /// The shape of a relief, one of those in `known`.
    fn shape(&self, relief: &'a Component, known: &[&str]) -> Option<&'a str> {
        let name = "shape_of_relief";
        if !self.reading.is_chosen(relief, name) {
            self.reading.assumed(relief, name, "linear");
            return Some("linear");
        }
        self.reading.choice(relief, name, known)
    }

    /// A relief that begins along an arc is none of ours.
    fn refuse_transition(&self, relief: &'a Component) -> Option<()> {
        let name = "specify_tangential_transition";
        if self.reading.choice(relief, name, &["true", "false"]) == Some("true") {
            let detail = "A relief begins with a corner here, or as its shape says; a tangential transition is not known.";
            self.reading.wrong(relief.place_of(name), detail);
            return None;
        }
        Some(())
    }

    /// The amount of the leads' crowning at both ends of the face, scaled from where it is said.
    fn helix_crowning(&self, crowning: &'a Component) -> Option<Value> {
        let reading = self.reading;
        let names = ENDS.map(|end| format!("helix_crowning_amount_{end}"));
        let [one, other] = names
            .each_ref()
            .map(|name| reading.number(crowning, name, MM));
        let Some(amount) = one.or(other) else {
            let detail = format!("It has neither {} nor {}.", names[0], names[1]);
            reading.wrong(crowning.place(), detail);
            return None;
        };
        if let Some(other) = other.filter(|other| (other - amount).abs() > 1e-4) {
            let detail = format!(
                "It takes off {amount} mm at the datum face and {other} mm at the other; a crowning has the same at both here. A helix_slope beside it says the rest."
            );
            reading.wrong(crowning.place(), detail);
            return None;
        }
        let shapes = ["parabolic", "circular"];
        reading.choice(crowning, "shape_of_helix_crowning", &shapes);
        let names = ENDS.map(|end| format!("coordinate_where_helix_crowning_is_specified_{end}"));
        let said = names.each_ref().map(|name| {
            let coordinate = reading.number(crowning, name, MM)?;
            Some((name.as_str(), coordinate))
        });
        let range = self.face_range(crowning, said)?;
        let width = self.face_width()?;
        let highest = "helix_highest_point";
        if let Some(at) = reading.number(crowning, highest, MM)
            && [0.0, 0.5 * width]
                .iter()
                .all(|middle| (at - middle).abs() > SAME)
        {
            let detail = format!(
                "It is {at} mm; a crowning is highest in the middle of the face here. A helix_slope beside it says the rest."
            );
            reading.wrong(crowning.place_of(highest), detail);
            return None;
        }
        let amount = amount * (width / range).powi(2);
        let amount = significant(um_of_mm(amount), DIGITS);
        Some(json!({ "kind": "crowning", "amount_um": amount }))
    }

    /// The slope of the leads over the whole face, from where it is said.
    fn helix_slope(&self, slope: &'a Component) -> Option<Vec<Value>> {
        let reading = self.reading;
        let amount = needed(reading, slope, "helix_slope", MM)?;
        reading.remark(format!(
            "Assumed: a positive helix_slope of {} takes material off at the +z end of the face, towards which the driving gear is seen to turn counter-clockwise.",
            slope.place()
        ));
        let names = ["helix_evaluation_start", "helix_evaluation_end"];
        let said = names.map(|name| Some((name, reading.number(slope, name, MM)?)));
        let name = "helix_evaluation_reference";
        let references = ["facewidth", "facewidth_usable", "helix_evaluation_length"];
        let reference = reading.choice(slope, name, &references);
        let width = self.face_width()?;
        let range = match reference {
            Some("facewidth") => width,
            Some(other) if said == [None, None] => {
                let detail = format!(
                    "It is {other}; how long that is, {} and {} would say.",
                    names[0], names[1]
                );
                reading.wrong(slope.place_of(name), detail);
                return None;
            }
            _ => self.face_range(slope, said)?,
        };
        let whole = significant(um_of_mm(amount * width / range), DIGITS);
        let mut leads = vec![json!({ "kind": "slope", "amount_um": whole })];
        // The modification is zero where the range begins, and not at the end of the face.
        leads.extend(
            self.constant(0.5 * (amount - amount * width / range), |removed| {
                let end = significant(0.5 * width, DIGITS);
                json!({ "kind": "table", "z_mm": [-end, end], "removed_um": removed })
            }),
        );
        Some(leads)
    }

    fn face_width(&self) -> Option<f64> {
        self.reading.number(self.gear, "face_width", MM)
    }

    /// The length of the part of the face between two coordinates, which lie alike to its middle: from an end of the face on, or
    /// from its middle. The whole of it if none is said.
    fn face_range(&self, of: &Component, said: [Option<(&str, f64)>; 2]) -> Option<f64> {
        let width = self.face_width()?;
        let (name, range) = match said {
            [None, None] => return Some(width),
            [Some((_, one)), Some((name, other))] => {
                let middle = 0.5 * (one + other);
                let alike = [0.0, 0.5 * width]
                    .iter()
                    .any(|at| (middle - at).abs() <= 1e-3 * width);
                let length = (other - one).abs();
                (name, (alike && length > 0.0).then_some(length))
            }
            [Some((name, _)), None] | [None, Some((name, _))] => (name, None),
        };
        if range.is_none() {
            let detail = "What is said between two places along the face is taken if they lie alike to its middle.";
            self.reading.wrong(of.place_of(name), detail);
        }
        range
    }

    fn relief(&self, relief: &'a Component, names: &ReliefNames) -> Option<Value> {
        let reading = self.reading;
        let amount = um_of_mm(needed(reading, relief, names.depth, MM)?);
        let shape = self.shape(relief, &["linear", "parabolic"])?;
        self.refuse_transition(relief)?;
        self.refuse_other_reference(relief, names)?;
        let diameter = reading.number(relief, names.diameter, MM);
        let start = match diameter {
            Some(diameter) => json!({ "diameter_mm": diameter }),
            None => match reading.number(relief, names.length, MM) {
                Some(length) => json!({ names.roll_length: length }),
                None => {
                    let detail = format!(
                        "It has neither {} nor {}: where does it begin?",
                        names.diameter, names.length
                    );
                    reading.wrong(relief.place(), detail);
                    return None;
                }
            },
        };
        Some(json!({ "kind": names.kind, "amount_um": amount, "shape": shape, "start": start }))
    }

    /// The depth of a relief is that at the end of the flank, whatever the model calls it by.
    fn refuse_other_reference(&self, relief: &'a Component, names: &ReliefNames) -> Option<()> {
        let reading = self.reading;
        let (at, away) = (
            format!("{}_evaluation_reference", names.kind),
            format!("{}_evaluation_reference_length", names.kind),
        );
        if let Some(length) = reading
            .number(relief, &away, MM)
            .filter(|length| *length != 0.0)
        {
            let detail = format!(
                "The depth is said at {length} mm from the end of the flank; a relief has its amount at the end here."
            );
            reading.wrong(relief.place_of(&away), detail);
            return None;
        }
        let Some(said) = reading.number(relief, &at, MM) else {
            return Some(());
        };
        let (name, end) = match names.kind {
            "tip_relief" => ("tip circle", Some(2.0 * self.tip_radius())),
            _ => ("form circle", self.form_length().map(|s| self.diameter(s))),
        };
        if end.is_some_and(|end| (said - end).abs() <= 2.0 * SAME) {
            return Some(());
        }
        let end = end.map_or_else(String::new, |end| format!(", {} mm", significant(end, 8)));
        let detail = format!(
            "The depth is said at {said} mm; a relief has its amount at the {name} here{end}."
        );
        reading.wrong(relief.place_of(&at), detail);
        None
    }

    /// A crowning of the profile as a submission has it: the parabola with the given amounts at the two diameters, and zero midway between them.
    fn crowning(&self, crowning: &'a Component) -> Option<Vec<Value>> {
        let reading = self.reading;
        let tip = needed(reading, crowning, "profile_crowning_at_tip", MM)?;
        let root = reading
            .number(crowning, "profile_crowning_at_root", MM)
            .unwrap_or(tip);
        if (tip - root).abs() > 1e-4 {
            let detail = format!(
                "It takes off {tip} mm at the tip and {root} mm at the root; a crowning has the same at both here. A profile_slope beside it says the rest."
            );
            reading.wrong(crowning.place(), detail);
            return None;
        }
        // A circle and a parabola of so little height are the same to a millionth of it.
        let shapes = ["parabolic", "circular"];
        reading.choice(crowning, "shape_of_profile_crowning", &shapes);
        let names = ["root", "tip"].map(|end| {
            let place = format!("where_profile_crowning_{end}_is_specified");
            [format!("diameter_{place}"), format!("length_{place}")]
        });
        let [at_root, at_tip] = names.each_ref().map(|names| self.place(crowning, names));
        let (from, to) = (at_root?, at_tip?);
        let range = self.range(crowning, &names[1][0], from, to)?;
        let highest = "profile_highest_point";
        if let Some(at) = reading.number(crowning, highest, MM) {
            let whole = || Some([self.form_length()?, self.tip_length()]);
            let middle = range
                .or_else(whole)
                .map(|[from, to]| self.diameter(f64::midpoint(from, to)));
            if middle.is_none_or(|middle| (at - middle).abs() > 0.01 * self.module) {
                let detail = format!(
                    "It is {at} mm; a crowning is highest midway between its ends here{}. A profile_slope beside it says the rest.",
                    middle.map_or_else(String::new, |middle| format!(
                        ", at the diameter {} mm",
                        significant(middle, 6)
                    ))
                );
                reading.wrong(crowning.place_of(highest), detail);
                return None;
            }
        }
        match range {
            None => Some(vec![
                json!({ "kind": "crowning", "amount_um": um_of_mm(tip) }),
            ]),
            Some(range) => Some(self.over_flank(tip, 0.0, range)),
        }
    }

    /// A slope of the profile as a submission has it: nothing where its evaluation begins, the amount where it is said.
    fn slope(&self, slope: &'a Component) -> Option<Vec<Value>> {
        let reading = self.reading;
        let amount = needed(reading, slope, "profile_slope", MM)?;
        reading.remark(format!(
            "Assumed: a positive profile_slope of {} takes material off at the tip.",
            slope.place()
        ));
        let names = [
            ["profile_evaluation_start", ""],
            [
                "diameter_where_profile_slope_amount_is_specified",
                "rolling_length_where_profile_slope_amount_is_specified",
            ],
        ];
        let [start, said] = names.map(|names| self.place(slope, &names.map(str::to_owned)));
        let end = self.place(slope, &["profile_evaluation_end".to_owned(), String::new()]);
        let (start, end) = (start?, said?.or(end?));
        match self.range(slope, names[1][0], start, end)? {
            None => {
                let amount = um_of_mm(amount);
                Some(vec![json!({ "kind": "slope", "amount_um": amount })])
            }
            Some(range) => Some(self.over_flank(0.0, amount, range)),
        }
    }

    /// The roll length of the diameter that the first of two attributes says; the second would say it as a length, along which it is not
    /// known from where.
    fn place(&self, of: &'a Component, names: &[String; 2]) -> Option<Option<f64>> {
        let reading = self.reading;
        let Some(diameter) = reading.number(of, &names[0], MM) else {
            if reading.number(of, &names[1], MM).is_some() {
                let detail = format!("Say it as a diameter, by {}.", names[0]);
                reading.wrong(of.place_of(&names[1]), detail);
                return None;
            }
            return Some(None);
        };
        let base = 2.0 * self.base_radius();
        if diameter < base {
            let detail = format!(
                "It is {diameter} mm; a diameter of the flank is expected, not below that of the base circle, {} mm.",
                significant(base, 8)
            );
            reading.wrong(of.place_of(&names[0]), detail);
            return None;
        }
        Some(Some(self.roll_length(diameter)))
    }

    /// The roll lengths between which an amount is said, if one of them is; the other is the end of the flank then.
    fn range(
        &self,
        of: &'a Component,
        name: &str,
        from: Option<f64>,
        to: Option<f64>,
    ) -> Option<Option<[f64; 2]>> {
        if from.is_none() && to.is_none() {
            return Some(None);
        }
        let from = from.or_else(|| self.form_length());
        let to = to.unwrap_or_else(|| self.tip_length());
        let Some(from) = from.filter(|from| to - from > 0.05 * self.module) else {
            let detail = "Nothing of the flank lies between the diameters where the amount is said, or it is undercut and only one of them is.";
            self.reading.wrong(of.place_of(name), detail);
            return None;
        };
        Some(Some([from, to]))
    }

    /// The modification with `crowning` at both ends of a range of roll lengths and zero in its middle, and `slope` at its end and zero at its beginning: over
    /// the whole flank, from its form circle to its tip circle, as a submission has it.
    fn over_flank(&self, crowning: f64, slope: f64, [from, to]: [f64; 2]) -> Vec<Value> {
        let um = |length: f64| significant(um_of_mm(length), DIGITS);
        let (tip, h) = (self.tip_length(), 0.5 * (to - from));
        // c(s) = crowning e^2 + slope (1 + e)/2, with e how far s is from the middle of the range, in halves of it.
        let place = |s: f64| (s - f64::midpoint(from, to)) / h;
        let value = |e: f64| crowning * e * e + 0.5 * slope * (1.0 + e);
        let Some(form) = self.form_length() else {
            // Of an undercut flank it is not known here where it begins.
            let places = (0..=PIECES).map(|i| tip * f64::from(i) / f64::from(PIECES));
            let places: Vec<f64> = places.map(|s| significant(s, DIGITS)).collect();
            let removed: Vec<f64> = places.iter().map(|s| um(value(place(*s)))).collect();
            return vec![
                json!({ "kind": "table", "roll_length_mm": places, "removed_um": removed }),
            ];
        };
        // The same about the middle of the flank.
        let half = 0.5 * (tip - form);
        let e = place(f64::midpoint(form, tip));
        let rise = (2.0 * crowning * e + 0.5 * slope) * half / h;
        let mut found = Vec::new();
        if crowning != 0.0 {
            let amount = um(crowning * (half / h).powi(2));
            found.push(json!({ "kind": "crowning", "amount_um": amount }));
        }
        if rise.abs() > NOTHING {
            found.push(json!({ "kind": "slope", "amount_um": um(2.0 * rise) }));
        }
        found.extend(self.constant(value(e) - rise, |removed| {
            let end = significant(tip, DIGITS);
            json!({ "kind": "table", "roll_length_mm": [0.0, end], "removed_um": removed })
        }));
        found
    }

    /// A table that takes off the same everywhere, unless that is nothing.
    fn constant(&self, removed: f64, table: impl Fn([f64; 2]) -> Value) -> Option<Value> {
        let um = significant(um_of_mm(removed), DIGITS);
        (removed.abs() > NOTHING).then(|| table([um, um]))
    }
}

/// The pieces of a table in place of a parabola, which it leaves by less than a thousandth of its height.
const PIECES: u32 = 48;

/// Less than this is nothing, in mm: a thousandth of a nanometer.
const NOTHING: f64 = 1e-9;
