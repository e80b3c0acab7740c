//! Teeth drawn at random, for those who have no measured ones.

use axum::Json;
use meshwright_wire::draw::DrawDocument;
use meshwright_wire::{Draw, DrawnDeviations};

use super::blocking::blocking;
use super::body::JsonBody;
use super::client::Onlooker;
use super::problem::Refusal;

/// Draw deviations
///
/// Takes a gear and an accuracy class of ISO 1328-1:2013, and answers with teeth as a production of that class makes them: single
/// pitches and profile slopes of each tooth and an eccentricity, normally distributed, so that a tolerance is three standard deviations wide at a
/// capability of 1. Gears that an inspector would reject are drawn again. The same seed gives the same teeth on every machine.
#[utoipa::path(
    post, path = "/v1/draw-deviations", tag = "Reference", operation_id = "draw_deviations",
    request_body(content = DrawDocument, content_type = "application/json", description = "The gear, the class, and the seed."),
    responses(
        (status = 200, description = "The teeth.", body = DrawnDeviations),
        JsonBody,
        (status = 422, description = "The gear cannot be made, there is no such class, or fewer than one gear in a hundred would pass the inspection; `errors` says which field is why."),
    ),
)]
pub(super) async fn draw(
    onlooker: Onlooker,
    JsonBody(document, _memory): JsonBody,
) -> Result<Json<DrawnDeviations>, Refusal> {
    let made = blocking(onlooker.name(), move |run| {
        Draw::parse(&document, run).and_then(|draw| draw.drawn())
    });
    Ok(Json(made.await??))
}
