//! Ollama, its native `/api/chat`: the only one of its interfaces that lets the context and thinking be set. A prompt
//! that does not fit is cut by the server without a word, so its length is checked before and after.

use serde_json::{Map, Value, json};

use crate::answer::{Answer, Finish, Usage};
use crate::error::Error;
use crate::providers::gemini::broken_off;
use crate::providers::http::{Http, Wire, count, done, text, truncated};
use crate::providers::openai::turns;
use crate::providers::{Config, Entry, Failure, Fix, Turn, Tweaks};
use crate::request::Request;
use crate::stream::Documents;
use crate::transport::Call;

const BASE_URL: &str = "http://127.0.0.1:11434";
/// The smallest context that is asked for, in tokens.
const MIN_CONTEXT: u64 = 8192;
/// Contexts are a multiple of this, so that the model is not loaded anew for every request.
const CONTEXT_STEP: u64 = 4096;
/// More bytes a token than any prompt has on the whole.
const MAX_BYTES_PER_TOKEN: u64 = 10;

pub(super) const ENTRY: Entry = Entry {
    name: "ollama",
    about: "Ollama on this machine, /api/chat; does not search",
    base_url: BASE_URL,
    key_variable: None,
    searches: false,
    build: |config| Http::build("ollama", BASE_URL, config, |config| Chat { config }),
};

struct Chat {
    config: Config,
}

impl Chat {
    /// Returns the context to ask for, in tokens.
    fn context(&self, request: &Request) -> u64 {
        let needed = request.estimated_input_tokens() + u64::from(request.max_output_tokens);
        let fitted = needed.max(MIN_CONTEXT).div_ceil(CONTEXT_STEP) * CONTEXT_STEP;
        self.config.context_tokens.map_or(fitted, u64::from)
    }

    /// Returns what to say about thinking; nothing where the model knows no thinking.
    fn think(&self, tweaks: &Tweaks) -> Option<Value> {
        let other = tweaks.fixes.contains(&Fix::OtherThink);
        let plain = |on: bool| json!(on != other);
        match self.config.thinking.as_deref() {
            _ if tweaks.fixes.contains(&Fix::WithoutThinking) => None,
            None | Some("off" | "none" | "false") => Some(plain(false)),
            Some("on" | "true") => Some(plain(true)),
            Some(_) if other => Some(json!(false)),
            Some(level) => Some(json!(level)),
        }
    }
}

impl Wire for Chat {
    fn encode(&self, request: &Request, tweaks: &Tweaks) -> Result<Call, Error> {
        if request.grounding.is_some() {
            return Err(Error::config("ollama cannot search the web; name documents instead"));
        }
        let context = self.context(request);
        let least = request.prompt_bytes() as u64 / MAX_BYTES_PER_TOKEN;
        if least >= context {
            let message = format!("at least {least} tokens, and the context has {context}");
            return Err(Error::TooLong { message });
        }
        let mut body = Map::new();
        body.insert("model".into(), json!(self.config.model));
        let system = request.system.as_ref().map(|s| json!({"role": "system", "content": s}));
        body.insert("messages".into(), system.into_iter().chain(turns(request)).collect());
        body.insert("stream".into(), json!(false));
        if let Some(schema) = &request.schema {
            body.insert("format".into(), schema.wire().clone());
        }
        if let Some(think) = self.think(tweaks) {
            body.insert("think".into(), think);
        }
        let mut options = json!({"num_ctx": context, "num_predict": request.max_output_tokens});
        if let Some(t) = self.config.temperature {
            options["temperature"] = json!(t);
        }
        if let Some(seed) = self.config.seed {
            options["seed"] = json!(seed);
        }
        body.insert("options".into(), options);
        let url = self.config.url(BASE_URL, "api", "chat")?;
        Call::new(url, Some(Value::Object(body))).key("authorization", "Bearer ", self.config.key.as_ref())
    }

    fn decode(&self, request: &Request, _tweaks: &Tweaks, documents: Documents) -> Result<Turn, Failure> {
        let said = documents.items.iter().filter_map(|d| d.get("message"));
        let mut answer = Answer { text: said.map(|m| text(m, "content")).collect(), ..Answer::default() };
        let Some(last) = documents.items.last() else { return Err(broken_off(Usage::default())) };
        answer.model = text(last, "model").to_owned();
        let (input, output) = (count(last.get("prompt_eval_count")), count(last.get("eval_count")));
        answer.usage = Usage { input, output, ..Usage::default() };
        if documents.streamed && last.get("done") != Some(&Value::Bool(true)) {
            return Err(broken_off(answer.usage));
        }
        let context = self.context(request);
        // A prompt that is too long is cut without a word and then fills the context. A small count is no sign of that:
        // servers leave out what they still had from the request before.
        if input + 1 >= context {
            let message = format!("the server read {input} tokens of it, with a context of {context}");
            return Err(Failure::from(Error::TooLong { message }).with_usage(answer.usage));
        }
        answer.finish = match last.get("done_reason").and_then(Value::as_str) {
            Some("stop") => Finish::Stop,
            Some("length") => return Err(truncated(request, answer)),
            Some(other) => Finish::Other(other.to_owned()),
            None => Finish::Unknown,
        };
        // Thinking and a format get into each other's way in some versions: all goes into thoughts, nothing is said.
        done(request, &self.config.model, answer).map_err(|f| Failure { fix: Some(Fix::OtherThink), ..f })
    }

    fn models_call(&self) -> Result<Call, Error> {
        let url = self.config.url(BASE_URL, "api", "tags")?;
        Call::new(url, None).key("authorization", "Bearer ", self.config.key.as_ref())
    }

    fn fix_for_invalid(&self) -> Option<Fix> {
        Some(Fix::OtherThink)
    }
}
