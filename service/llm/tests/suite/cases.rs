//! Makes a client and a request out of a fixture: the request it shows is rebuilt with this crate's own types.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use d3dgen_llm::{
    Answer, Budget, Client, Config, Error, Grounding, Message, Request, RetryPolicy, Role, Schema, Secret, Structured,
    TokenField, providers,
};
use serde_json::{Value, json};

use crate::server::{Reply, Seen, Server};

/// A key that no text of a fixture holds.
pub const KEY: &str = "test-key-0f1e2d3c4b5a";

/// One exchange with what to make of it.
pub struct Case {
    pub name: String,
    pub config: Config,
    pub request: Request,
    pub replies: Vec<Reply>,
    /// The fixture as it is.
    pub fixture: Value,
    /// Whether models are listed, instead of a request made.
    pub lists_models: bool,
}

/// What came of it.
pub struct Outcome {
    pub answer: Result<Answer, Error>,
    pub models: Option<Result<Vec<String>, Error>>,
    pub seen: Vec<Seen>,
    pub waits: Vec<Duration>,
}

impl Case {
    /// Reads a fixture of a folder.
    pub fn of(folder: &str, name: &str, fixture: Value) -> Self {
        let asked = &fixture["request"];
        let path = asked["path"].as_str().unwrap_or_default();
        let body = &asked["body"];
        let provider = match folder {
            _ if path.ends_with("/responses") => "openai_responses",
            _ if path.ends_with("/messages") => "anthropic",
            "openai_compat" => "openai",
            folder => folder,
        };
        let model = body["model"].as_str().or_else(|| path.split("models/").nth(1)?.split(':').next());
        let mut config = Config::new(provider, model.unwrap_or("some-model"));
        let at = |path: &str| body.pointer(path);
        let thinking = at("/generationConfig/thinkingConfig/thinkingLevel").or(at("/generation_config/thinking_level"));
        config.thinking = thinking.and_then(Value::as_str).map(str::to_owned);
        config.temperature = at("/temperature").or(at("/options/temperature")).and_then(Value::as_f64);
        config.seed = at("/options/seed").and_then(Value::as_u64);
        config.stream = path.contains("streamGenerateContent");
        let new_field = at("/max_completion_tokens").is_some() && at("/max_tokens").is_none();
        config.token_field = new_field.then_some(TokenField::MaxCompletionTokens);
        if at("/tool_choice/name").is_some() {
            config.structured = Structured::Tool;
        }
        let replies = vec![Reply::of_fixture(&fixture["response"])];
        let lists_models = asked["method"] == "GET";
        let request = request(name, body, &fixture["expect"]);
        Self { name: format!("{folder}/{name}"), config, request, replies, fixture, lists_models }
    }

    /// Reads one of the project's own: `ask` says what is asked for instead of a request.
    pub fn own(provider: &str, fixture: Value) -> Self {
        let name = fixture["name"].as_str().expect("a fixture has a name").to_owned();
        let mut request = Request::new(&name, "What is in {this}? two-bedroom flat, 30 m²");
        match fixture["ask"].as_str() {
            Some("json") => request.schema = Some(flat_schema()),
            Some("search") => request.grounding = Some(Grounding::default()),
            Some("text" | "models") => {}
            other => panic!("{provider}/{name}: ask is {other:?}"),
        }
        let mut config = Config::new(provider, "some-model");
        for (key, value) in fixture["config"].as_object().into_iter().flatten() {
            match (key.as_str(), value) {
                ("thinking", Value::String(level)) => config.thinking = Some(level.clone()),
                ("temperature", value) => config.temperature = value.as_f64(),
                ("stream", value) => config.stream = value.as_bool().unwrap(),
                ("new_token_field", _) => config.token_field = Some(TokenField::MaxCompletionTokens),
                ("tool", _) => config.structured = Structured::Tool,
                other => panic!("{provider}/{name}: config {other:?}"),
            }
        }
        let responses = match &fixture["response"] {
            Value::Array(several) => several.iter().map(Reply::of_fixture).collect(),
            one => vec![Reply::of_fixture(one)],
        };
        let lists_models = fixture["ask"] == "models";
        Self { name: format!("own {provider}/{name}"), config, request, replies: responses, fixture, lists_models }
    }

    /// Plays it through the real client.
    pub async fn play(&self) -> Outcome {
        let server = Server::start(self.replies.clone()).await;
        let (client, waits) = client(self.config.clone(), &server, RetryPolicy::default(), Budget::unlimited());
        let models = if self.lists_models { Some(client.models().await) } else { None };
        let answer = match &models {
            Some(_) => Err(Error::Config { message: "only models were listed".into() }),
            None => client.complete(&self.request).await,
        };
        let waits = waits.lock().unwrap().clone();
        Outcome { answer, models, seen: server.seen(), waits }
    }
}

/// Returns the schema that most of the project's own fixtures ask for.
pub fn flat_schema() -> Schema {
    let schema = json!({
        "type": "object",
        "properties": {"kind": {"type": "string", "enum": ["home", "work"]}, "area_m2": {"type": ["number", "null"]}},
        "required": ["kind", "area_m2"],
        "additionalProperties": false,
    });
    Schema::new("flat", schema).unwrap()
}

/// Makes a client of a server that notes waits instead of waiting.
pub fn client(
    mut config: Config,
    server: &Server,
    policy: RetryPolicy,
    budget: Budget,
) -> (Client, Arc<Mutex<Vec<Duration>>>) {
    let version = if config.provider.starts_with("openai") { "/v1" } else { "" };
    config.base_url = Some(format!("{}{version}", server.url));
    config.key.get_or_insert(Secret::new(KEY));
    let waits = Arc::new(Mutex::new(Vec::new()));
    let log = Arc::clone(&waits);
    let sleep = Arc::new(move |wait| -> providers::BoxFuture<'static, ()> {
        log.lock().unwrap().push(wait);
        Box::pin(async {})
    });
    (Client::new(providers::build(config).unwrap(), policy, budget).with_sleep(sleep), waits)
}

/// Rebuilds the request of a fixture.
fn request(name: &str, body: &Value, expect: &Value) -> Request {
    let at = |path: &str| body.pointer(path);
    let text = |path: &str| at(path).and_then(Value::as_str).map(str::to_owned);
    let mut turns = Vec::new();
    let mut system = text("/systemInstruction/parts/0/text").or(text("/system_instruction")).or(text("/system"));
    for list in ["/messages", "/contents", "/input"] {
        for turn in at(list).and_then(Value::as_array).into_iter().flatten() {
            let said = turn.get("content").or_else(|| turn.pointer("/parts/0/text")).and_then(Value::as_str);
            match turn["role"].as_str() {
                Some("system") => system = said.map(str::to_owned),
                role => turns.push((role == Some("user"), said.unwrap_or_default().to_owned())),
            }
        }
    }
    turns.extend(text("/input").map(|t| (true, t)));
    if turns.is_empty() {
        turns.push((true, "two-bedroom flat".to_owned()));
    }
    let role = |user| if user { Role::User } else { Role::Assistant };
    let mut request = Request::new(name, "");
    request.messages = turns.into_iter().map(|(user, text)| Message { role: role(user), text }).collect();
    request.system = system;
    let tools = at("/tools").and_then(Value::as_array).cloned().unwrap_or_default();
    let search = tools.iter().find(|t| t.get("google_search").is_some() || t["type"] != Value::Null);
    if let Some(search) = search.filter(|t| t.get("input_schema").is_none()) {
        let country = search.pointer("/user_location/country").and_then(Value::as_str).map(str::to_owned);
        let max_searches = search["max_uses"].as_u64().unwrap_or(10) as u32;
        request.grounding = Some(Grounding { max_searches, country, ..Grounding::default() });
    } else {
        request.schema = schema(body, expect);
    }
    let limits = [
        "/generationConfig/maxOutputTokens",
        "/generation_config/max_output_tokens",
        "/max_tokens",
        "/max_completion_tokens",
        "/max_output_tokens",
        "/options/num_predict",
    ];
    if let Some(limit) = limits.iter().find_map(|l| at(l)?.as_u64()) {
        request.max_output_tokens = limit as u32;
    }
    request
}

/// Returns the schema that a request asks for, or one for the JSON that is expected.
fn schema(body: &Value, expect: &Value) -> Option<Schema> {
    let places = [
        "/generationConfig/responseJsonSchema",
        "/response_format/schema",
        "/response_format/json_schema/schema",
        "/text/format/schema",
        "/output_config/format/schema",
        "/tools/0/input_schema",
        "/format",
    ];
    let found = places.iter().find_map(|p| body.pointer(p)).cloned();
    let name = ["/response_format/json_schema/name", "/text/format/name", "/tools/0/name"];
    let name = name.iter().find_map(|p| body.pointer(p)?.as_str()).unwrap_or("answer");
    let expected = || {
        let json = expect.get("json").or(expect.get("json_after_repair"))?.as_object()?;
        let property = |(key, value): (&String, &Value)| {
            let kind = match value {
                Value::Bool(_) => "boolean",
                Value::Number(_) => "number",
                _ => "string",
            };
            (key.clone(), json!({"type": [kind, "null"]}))
        };
        let properties: serde_json::Map<String, Value> = json.iter().map(property).collect();
        let required: Vec<&String> = json.keys().collect();
        Some(json!({"type": "object", "properties": properties, "required": required, "additionalProperties": false}))
    };
    Schema::new(name, found.or_else(expected)?).ok()
}
