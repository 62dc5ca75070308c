import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vite";

/** The server to develop against. */
const server = process.env.D3DGEN_SERVER ?? "http://127.0.0.1:50051";

export default defineConfig({
  plugins: [svelte()],
  build: {
    target: "es2023",
    // the server's Content-Security-Policy allows no inline data, and every name carries its hash
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 900,
    reportCompressedSize: false,
  },
  server: {
    proxy: {
      "^/(d3dgen\\.v1\\.|worlds/)": {
        target: server,
        changeOrigin: true,
        // to the server, the page is its own
        configure: (proxy) => proxy.on("proxyReq", (request) => request.removeHeader("origin")),
      },
    },
  },
});
