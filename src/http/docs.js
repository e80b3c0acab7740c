// Addresses are relative to /docs/, so that the page also works behind a prefix; the usual validator is on another host.
window.onload = () => {
  window.ui = SwaggerUIBundle({
    "url": "../openapi.json",
    "dom_id": "#swagger-ui",
    "deepLinking": true,
    "validatorUrl": "none",
    "presets": [SwaggerUIBundle.presets.apis, SwaggerUIStandalonePreset],
    "plugins": [SwaggerUIBundle.plugins.DownloadUrl],
    "layout": "StandaloneLayout",
  });
};
