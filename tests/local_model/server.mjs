// A model file as a server of chat completions on loopback: as much of the protocol as d3dgen's provider `openai` speaks.
//
//   node server.mjs MODEL.gguf NODE_MODULES     prints its port, then answers until it is ended
//
// Answers are held to the JSON schema of the request by a grammar, so the form is right; the content is up to the model.
import http from "node:http";
import path from "node:path";
import {pathToFileURL} from "node:url";

const [model_path, modules] = process.argv.slice(2);
const entry = pathToFileURL(path.join(path.resolve(modules), "node-llama-cpp", "dist", "index.js"));
const {getLlama, LlamaChatSession} = await import(entry);

const llama = await getLlama({gpu: false, build: "never", progressLogs: false, maxThreads: 1});
const model = await llama.loadModel({modelPath: model_path});
// Short, so that an answer takes seconds on an old processor; and a small model never ends a list by itself.
const context_tokens = 1024;
const most_tokens = 300;

// What the grammar takes: no unions of types in one `type`.
function plain(schema) {
    if (Array.isArray(schema)) return schema.map(plain);
    if (schema === null || typeof schema !== "object") return schema;
    const out = {};
    for (const [key, value] of Object.entries(schema)) {
        if (key === "type" && Array.isArray(value)) out.type = value.find((t) => t !== "null");
        else if (key === "items") out.items = plain(value);
        else if (key === "properties") {
            out.properties = Object.fromEntries(Object.entries(value).map(([k, v]) => [k, plain(v)]));
        } else if (key === "type" || key === "enum") out[key] = value;
    }
    if (out.type === "array") out.maxItems = 5;
    return out;
}

async function answer(request, signal) {
    const said = request.messages ?? [];
    const system = said.filter((m) => m.role === "system").map((m) => m.content).join("\n");
    // the question is longer than the model's memory: its begin and its end
    const asked = said.filter((m) => m.role === "user").at(-1)?.content ?? "";
    const half = 700;
    const short = asked.length > 2 * half ? asked.slice(0, half) + "\n...\n" + asked.slice(-half) : asked;
    const schema = request.response_format?.json_schema?.schema;
    const grammar = schema ? await llama.createGrammarForJsonSchema(plain(schema)) : undefined;
    const context = await model.createContext({contextSize: context_tokens});
    try {
        const session = new LlamaChatSession({contextSequence: context.getSequence(), systemPrompt: system.slice(0, 300)});
        const text = await session.prompt(short, {grammar, maxTokens: most_tokens, temperature: 0, signal});
        const used = {prompt_tokens: model.tokenize(short).length, completion_tokens: model.tokenize(text).length};
        return {
            id: "local", object: "chat.completion", created: 0, model: path.basename(model_path),
            choices: [{index: 0, message: {role: "assistant", content: text}, finish_reason: "stop"}],
            usage: {...used, total_tokens: used.prompt_tokens + used.completion_tokens},
        };
    } finally {
        await context.dispose();
    }
}

let last = Promise.resolve();
const server = http.createServer((req, res) => {
    let body = "";
    req.on("data", (piece) => (body += piece));
    req.on("end", async () => {
        const send = (status, value) => {
            res.writeHead(status, {"content-type": "application/json"});
            res.end(JSON.stringify(value));
        };
        // one after the other; who no longer waits is not answered
        const gone = new AbortController();
        res.on("close", () => gone.abort());
        const turn = last.then(() => answer(JSON.parse(body), gone.signal));
        last = turn.catch(() => {});
        try {
            send(200, await turn);
        } catch (error) {
            send(400, {error: {message: String(error), type: "invalid_request_error", code: null}});
        }
    });
});
server.requestTimeout = 0;
server.listen(0, "127.0.0.1", () => console.log(server.address().port));
