//! Parts of the OpenAPI document that concern many operations alike, or that its generator cannot say.

use serde_json::{Map, Value, json};

use super::listed_files::ListedFile;
use super::{studies, tables};

/// Completes the document.
pub(super) fn finish(document: &mut Value) {
    list_files(document);
    name_shapes(document);
    take_studies(document);
    let paths = document.get_mut("paths").and_then(Value::as_object_mut);
    for item in paths.into_iter().flat_map(Map::values_mut) {
        let operations = item.as_object_mut().into_iter().flat_map(Map::values_mut);
        for operation in operations {
            no_header_is_null(operation);
            say_when_to_return(operation);
        }
    }
    open_the_list_of_codes(document);
    describe_messages(document);
}

/// Puts an operation for each file in the place of one for all that a handler answers: clients are generated with one answer each.
fn list_files(document: &mut Value) {
    let Some(paths) = document.get_mut("paths").and_then(Value::as_object_mut) else {
        return;
    };
    let mut listed = Map::new();
    for (path, item) in std::mem::take(paths) {
        let (placeholder, files) = match path.rsplit_once('/') {
            Some((_, "{table}")) => ("table", tables::files()),
            Some((_, "{file}")) => ("file", studies::files()),
            _ => {
                listed.insert(path, item);
                continue;
            }
        };
        for file in files {
            let path = path.replace(&format!("{{{placeholder}}}"), file.name);
            listed.insert(path, of_file(item.clone(), placeholder, &file));
        }
    }
    *paths = listed;
}

/// The number of a mode is a part of the name of its file.
fn name_shapes(document: &mut Value) {
    let Some(paths) = document.get_mut("paths").and_then(Value::as_object_mut) else {
        return;
    };
    let named = std::mem::take(paths).into_iter();
    *paths = named
        .map(|(path, item)| match path.ends_with("/modes/{n}") {
            true => (format!("{path}.vtu"), item),
            false => (path, item),
        })
        .collect();
}

/// The checked document is a submission or a study.
fn take_studies(document: &mut Value) {
    let schema = "/paths/~1v1~1validate/post/requestBody/content/application~1json/schema";
    if let Some(schema) = document.pointer_mut(schema) {
        let of = |name: &str| json!({ "$ref": format!("#/components/schemas/{name}") });
        *schema = json!({ "oneOf": [of("Submission"), of("Study")] });
    }
}

/// The item of one file, made of that of all files, in whose words the placeholder stands for a file.
fn of_file(mut item: Value, placeholder: &str, file: &ListedFile) -> Value {
    let operation = &mut item["get"];
    let word = file.name.replace(['-', '.'], "_");
    if let Some(id) = operation["operationId"].as_str() {
        operation["operationId"] = id.replace(placeholder, &word).into();
    }
    if let Some(summary) = operation["summary"].as_str() {
        let place = format!("{{{placeholder}}}");
        operation["summary"] = summary.replace(&place, file.name).into();
    }
    if let Some(about) = file.about {
        operation["description"] = about.into();
    }
    if let Some(parameters) = operation["parameters"].as_array_mut() {
        let is_taken = |name: &str| name != placeholder && !file.without.contains(&name);
        parameters.retain(|parameter| parameter["name"].as_str().is_some_and(is_taken));
    }
    let schema = match (file.schema, file.media_type) {
        (Some(name), _) => json!({ "$ref": format!("#/components/schemas/{name}") }),
        (None, "application/octet-stream") => json!({ "type": "string", "format": "binary" }),
        (None, _) => json!({ "type": "string" }),
    };
    operation["responses"]["200"]["content"] = json!({ file.media_type: { "schema": schema } });
    item
}

/// A header that is left out is absent; none has the word null.
fn no_header_is_null(operation: &mut Value) {
    let parameters = operation.get_mut("parameters");
    let parameters = parameters.and_then(Value::as_array_mut);
    for parameter in parameters.into_iter().flatten() {
        let kind = match parameter["schema"]["type"].as_array().map(Vec::as_slice) {
            Some([kind, _]) if parameter["in"] == "header" => kind.clone(),
            _ => continue,
        };
        parameter["schema"]["type"] = kind;
    }
}

/// Declares `Retry-After` wherever a request may be sent again.
fn say_when_to_return(operation: &mut Value) {
    for status in ["429", "503"] {
        let Some(response) = operation["responses"].get_mut(status) else {
            continue;
        };
        // Health is no refusal.
        let is_problem = response["content"]
            .get("application/problem+json")
            .is_some();
        if is_problem {
            response["headers"]["Retry-After"] = json!({
                "description": "Seconds after which it is worth trying again.",
                "schema": { "type": "integer", "format": "int32", "minimum": 1 },
            });
        }
    }
}

/// A code that is not listed may come: later versions add some.
fn open_the_list_of_codes(document: &mut Value) {
    let Some(code) = document.pointer_mut("/components/schemas/Code") else {
        return;
    };
    if let Some(fields) = code.as_object_mut()
        && let Some(known) = fields.shift_remove("enum")
    {
        fields.insert("x-known-values".to_owned(), known);
        let about = "The stable code of a problem. The list is open: later versions add codes, and a client treats one that it does not know by its status.";
        fields.insert("description".to_owned(), about.into());
    }
}

/// Messages to webhooks.
fn describe_messages(document: &mut Value) {
    let status = document.pointer("/components/schemas/Status").is_some();
    let status = match status {
        true => json!({ "$ref": "#/components/schemas/Status" }),
        false => json!({ "type": "string" }),
    };
    let message = |kind: &str, data: Value| {
        json!({
            "type": "object",
            "title": "WebhookMessage",
            "required": ["type", "timestamp", "data"],
            "properties": {
                "type": { "type": "string", "const": kind },
                "timestamp": { "type": "string", "format": "date-time", "description": "When what is told happened (UTC)." },
                "data": data,
            },
        })
    };
    let of_work = |what: &str| {
        json!({
            "type": "object",
            "required": ["id", "status"],
            "properties": {
                "id": { "type": "string", "format": "uuid", "description": format!("The id of the {what}.") },
                "status": status,
                "by": { "type": "string", "description": "`administrator` where an administrator of the service did it; absent elsewhere." },
            },
        })
    };
    let of_webhook = json!({
        "type": "object",
        "required": ["id"],
        "properties": { "id": { "type": "string", "format": "uuid", "description": "The id of the webhook." } },
    });
    let mut webhooks = Map::new();
    for (kind, summary, data) in [
        (
            "job.ended",
            "A job that stands alone has ended",
            of_work("job"),
        ),
        ("study.ended", "A study has ended", of_work("study")),
        (
            "job.deleted",
            "An administrator has deleted a job",
            of_work("job"),
        ),
        (
            "study.deleted",
            "An administrator has deleted a study",
            of_work("study"),
        ),
        ("webhook.ping", "A ping was asked for", of_webhook),
    ] {
        let header = |name: &str, about: &str| json!({ "name": name, "in": "header", "required": true, "description": about, "schema": { "type": "string" } });
        webhooks.insert(
            kind.to_owned(),
            json!({ "post": {
                "tags": ["Webhooks"],
                "summary": summary,
                "operationId": format!("told_{}", kind.replace('.', "_")),
                "parameters": [
                    header("webhook-id", "The id of the message, the same in every attempt."),
                    header("webhook-timestamp", "When it was sent, in seconds since 1970."),
                    header("webhook-signature", "Signatures as Standard Webhooks has them: `v1,` and base64, separated by spaces."),
                ],
                "requestBody": { "required": true, "content": { "application/json": { "schema": message(kind, data) } } },
                "responses": {
                    "2XX": { "description": "The message is taken." },
                    "410": { "description": "No more messages are wanted; the webhook is given up." },
                },
            } }),
        );
    }
    document["webhooks"] = Value::Object(webhooks);
}
