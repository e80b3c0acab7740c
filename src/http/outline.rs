//! The outline of a pair: numbers for pages that draw it, or the drawing itself. And the outline of a blank that a drawing comes to.

use axum::http::HeaderMap;
use axum::http::header::{ACCEPT, CONTENT_TYPE, HeaderValue, VARY};
use axum::response::Response;
use meshwright_engine::run::Run;
use meshwright_exchange::dxf::{self, Choices, TOLERANCE_MM, TOLERANCES_MM};
use meshwright_wire::gear::SideDocument;
use meshwright_wire::{Code, PairOutline, Problem, Submission};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::{IntoParams, ToSchema};

use super::answer::json;
use super::blocking::blocking;
use super::body::OutlineBody;
use super::client::Onlooker;
use super::parameters::{Parameters, invalid, number};
use super::pictures;
use super::problem::{Refusal, internal};

/// Media type of the outline of a drawing.
const DRAWN: &str = "application/vnd.meshwright.outline+json";

/// Choices that a drawing leaves open; a submission leaves none.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct DrawingParameters {
    /// Of a drawing: the one layer that is read; without it, all of them.
    #[param(example = "Holes")]
    layer: Option<String>,
    /// Of a drawing: the place of the axis of the gear, X,Y in the unit of the drawing; without it, its origin.
    #[param(
        example = "0,0",
        pattern = r"^[+-]?[0-9]{1,9}([.][0-9]{0,12})?,[+-]?[0-9]{1,9}([.][0-9]{0,12})?$"
    )]
    center: Option<String>,
    /// Of a drawing: ends no farther apart than this are joined, in mm; 0.01 without it.
    #[param(example = 0.01, minimum = 0.0, maximum = 0.1)]
    #[serde(default, deserialize_with = "number")]
    tolerance: Option<f64>,
    /// Of a drawing: the radius of the bore, in mm, where it is not drawn as a circle.
    #[param(example = 16.0, exclusive_minimum = 0.0)]
    #[serde(default, deserialize_with = "number")]
    bore_radius_mm: Option<f64>,
}

impl DrawingParameters {
    /// The choices of the parameters.
    ///
    /// # Errors
    ///
    /// `invalid_parameter`, if a number is none or out of its range.
    fn choices(self) -> Result<Choices, Problem> {
        let point = |text: String| {
            let said = dxf::point(&text);
            said.ok_or_else(|| {
                invalid(format!("center is {text:?}; X,Y is expected, two numbers."))
            })
        };
        let tolerance_mm = self.tolerance.unwrap_or(TOLERANCE_MM);
        if !TOLERANCES_MM.contains(&tolerance_mm) {
            let (least, most) = (TOLERANCES_MM.start(), TOLERANCES_MM.end());
            return Err(invalid(format!(
                "tolerance is {tolerance_mm} mm; {least} to {most} mm are taken."
            )));
        }
        if let Some(radius) = self
            .bore_radius_mm
            .filter(|radius| radius.is_nan() || *radius <= 0.0)
        {
            return Err(invalid(format!(
                "bore_radius_mm is {radius}; a radius above 0 is expected."
            )));
        }
        Ok(Choices {
            layers: self.layer.into_iter().collect(),
            center: self.center.map(point).transpose()?,
            tolerance_mm,
            bore_radius_mm: self.bore_radius_mm,
        })
    }
}

/// The outline of a drawing.
#[derive(Serialize, ToSchema)]
#[schema(as = DrawnOutline, title = "Outline of a drawing")]
pub(super) struct DrawnOutline {
    /// The loops, as `blank.outline` of a submission takes them.
    #[schema(value_type = Vec<Vec<SideDocument>>)]
    outline: Vec<Vec<Value>>,
    /// The radius of the bore, in mm: that of the request, or that of the smallest circle about the axis; null where there is neither.
    bore_radius_mm: Option<f64>,
    /// Assumptions, joined ends and entities left out, a sentence each.
    remarks: Vec<String>,
}

/// Get an outline
///
/// Takes a submission and answers with the pair as it is cut: the profile of a tooth of each gear, its holes, web and circles, where both
/// gears stand, and the line of action with its points A to E. Makes no job and computes no load: a drawing can follow the hand.
/// With `Accept: image/svg+xml` the answer is the drawing itself.
///
/// Takes a drawing in DXF as well, and answers with the openings that it comes to, for `blank.outline` of a submission.
#[utoipa::path(
    post, path = "/v1/outline", tag = "Reference", operation_id = "outline",
    request_body(content((Submission = "application/json"), (Value = "application/octet-stream")), description = "The submission, or a drawing in DXF: `application/octet-stream`, `image/vnd.dxf` or `application/dxf`."),
    params(DrawingParameters),
    responses(
        (status = 200, description = "The outline.", content((PairOutline = "application/json"), (String = "image/svg+xml"), (DrawnOutline = "application/vnd.meshwright.outline+json"))),
        OutlineBody,
        (status = 422, description = "The pair cannot be made, and `errors` says which field is why; or the drawing cannot be taken, and `detail` says why."),
    ),
)]
pub(super) async fn outline(
    onlooker: Onlooker,
    Parameters(parameters): Parameters<DrawingParameters>,
    request: HeaderMap,
    body: OutlineBody,
) -> Result<Response, Refusal> {
    let choices = parameters.choices()?;
    let (document, _memory) = match body {
        OutlineBody::Submission(document, memory) => (document, memory),
        OutlineBody::Drawing(drawing, memory) => {
            let read = move |_: &Run| {
                let read = drawn(&drawing, &choices);
                drop(memory);
                read
            };
            return blocking(onlooker.name(), read).await?;
        }
    };
    let as_picture = wants_picture(&request);
    let made = blocking(onlooker.name(), move |_| {
        let submission = Submission::parse(&document)?;
        let pair = &submission.case().pair;
        if as_picture {
            return Ok(pictures::answer(pictures::pair(pair)));
        }
        let outline = PairOutline::of(pair).to_json().map_err(|_| internal())?;
        Ok::<_, Refusal>(json(outline))
    });
    let mut response = made.await??;
    let headers = response.headers_mut();
    headers.insert(VARY, HeaderValue::from_static("accept"));
    Ok(response)
}

/// The answer to a drawing.
fn drawn(drawing: &[u8], choices: &Choices) -> Result<Response, Refusal> {
    let outline = dxf::outline(drawing, choices)
        .map_err(|refused| Problem::new(Code::DrawingRefused, refused.to_string().trim_end()))?;
    let view = DrawnOutline {
        outline: outline.loops,
        bore_radius_mm: outline.bore_radius_mm,
        remarks: outline.remarks,
    };
    let mut response = json(serde_json::to_string(&view).map_err(|_| internal())?);
    let headers = response.headers_mut();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(DRAWN));
    Ok(response)
}

/// True if the client asks for a picture by its media type.
fn wants_picture(request: &HeaderMap) -> bool {
    let mut accepted = request.get_all(ACCEPT).iter();
    accepted.any(|value| {
        value
            .to_str()
            .is_ok_and(|text| text.contains("image/svg+xml"))
    })
}
