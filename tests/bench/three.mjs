// Draws an OBJ with three.js in a headless Chromium and prints the milliseconds from the launch to
// the first picture, of a steady frame with Phong materials, and of one with standard ones, which
// have roughness and metalness maps, too.
// Usage: node three.mjs NODE_MODULES CHROMIUM OBJ WIDTHxHEIGHT CAMERA TARGET LIGHT  (X,Y,Z each)
import { spawn } from 'node:child_process';
import { createServer } from 'node:http';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, dirname, join, normalize } from 'node:path';

const [modules, chromium, obj, size, camera, target, light] = process.argv.slice(2);
const [width, height] = size.split('x').map(Number);
const name = basename(obj, '.obj');

const page = `<!doctype html><canvas id=c width=${width} height=${height}></canvas>
<script type=importmap>{"imports": {"three": "/modules/three/build/three.module.js",
    "three/addons/": "/modules/three/examples/jsm/"}}</script>
<script type=module>
import * as THREE from 'three';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { MTLLoader } from 'three/addons/loaders/MTLLoader.js';
const say = (what) => fetch('/said', { method: 'POST', body: JSON.stringify(what) });
try {
    const renderer = new THREE.WebGLRenderer({ canvas: document.getElementById('c'),
                                               preserveDrawingBuffer: true });
    renderer.setSize(${width}, ${height}, false);
    const loaded = new Promise((done) => { THREE.DefaultLoadingManager.onLoad = done; });
    const materials = await new MTLLoader().setPath('/scene/').loadAsync('${name}.mtl');
    materials.preload();
    const model = await new OBJLoader().setMaterials(materials).setPath('/scene/')
        .loadAsync('${name}.obj');
    await loaded;
    const scene = new THREE.Scene();
    scene.add(model, new THREE.AmbientLight(0xffffff, 0.3));
    const lamp = new THREE.PointLight(0xffffff, 3, 0, 0);
    lamp.position.set(${light});
    scene.add(lamp);
    const eye = new THREE.PerspectiveCamera(60, ${width / height}, 0.01, 1000);
    eye.position.set(${camera});
    eye.lookAt(${target});
    const gl = renderer.getContext(), pixel = new Uint8Array(4);
    const frame = () => {
        const start = performance.now();
        renderer.render(scene, eye);
        // Waits until it is drawn.
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        return performance.now() - start;
    };
    const median = (frames) => {
        for (let i = 0; i < 2; ++i) frame();
        const times = Array.from({ length: frames }, frame);
        return times.sort((a, b) => a - b)[frames >> 1];
    };
    frame();
    await say({ first: document.getElementById('c').toDataURL().length,
                renderer: gl.getParameter(gl.getExtension('WEBGL_debug_renderer_info')
                    ?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER) });
    const phong = median(9);
    // What MTLLoader leaves out, and cw2 draws.
    const statements = (await (await fetch('/scene/${name}.mtl')).text()).split('\\n')
        .map((line) => line.trim().split(/\\s+/));
    const maps = new Map();
    let material;
    for (const [key, ...rest] of statements) {
        if (key === 'newmtl') maps.set(rest.join(' '), material = {});
        const use = { map_Pr: 'roughnessMap', map_Pm: 'metalnessMap' }[key];
        if (!use) continue;
        const texture = await new THREE.TextureLoader().loadAsync('/scene/' + rest.join(' '));
        texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
        material[use] = texture;
    }
    model.traverse((mesh) => {
        if (!mesh.isMesh) return;
        const standard = (m) => new THREE.MeshStandardMaterial({ map: m.map, normalMap: m.normalMap,
            bumpMap: m.bumpMap, alphaMap: m.alphaMap, alphaTest: m.alphaMap ? 0.5 : 0,
            color: m.color, roughness: maps.get(m.name)?.roughnessMap ? 1 : 0.5,
            metalness: maps.get(m.name)?.metalnessMap ? 1 : 0, ...maps.get(m.name) });
        mesh.material = Array.isArray(mesh.material) ? mesh.material.map(standard)
                                                     : standard(mesh.material);
    });
    await say({ phong, standard: median(9) });
} catch (error) {
    await say({ error: String(error?.stack ?? error) });
}
</script>`;

const profile = mkdtempSync(join(tmpdir(), 'three-bench-'));
let browser, started, first;
function end(status) {
    browser?.kill('SIGKILL');
    server.close();
    server.closeAllConnections();
    setTimeout(() => { rmSync(profile, { recursive: true, force: true }); process.exit(status); }, 300);
}
const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://x').pathname));
    if (path === '/said') {
        let text = '';
        request.on('data', (part) => (text += part));
        request.on('end', () => {
            response.end();
            const said = JSON.parse(text);
            if (said.error) {
                console.error(said.error);
                end(1);
            } else if (said.first) {
                first = performance.now() - started;
                console.error(said.renderer);
            } else {
                console.log(`${first.toFixed(0)} ${said.phong.toFixed(1)} ${said.standard.toFixed(1)}`);
                end(0);
            }
        });
        return;
    }
    try {
        const file = path.startsWith('/modules/') ? join(modules, path.slice(9))
                   : path.startsWith('/scene/')   ? join(dirname(obj), path.slice(7)) : '';
        response.setHeader('Content-Type', file.endsWith('.js') ? 'text/javascript'
                                         : file ? 'application/octet-stream' : 'text/html');
        response.end(file ? readFileSync(file) : page);
    } catch {
        response.statusCode = 404;
        response.end();
    }
});
server.listen(0, '127.0.0.1', () => {
    started = performance.now();
    browser = spawn(chromium, ['--headless=new', '--no-sandbox', '--use-gl=angle',
        '--use-angle=gl-egl', '--ignore-gpu-blocklist',
        `--user-data-dir=${profile}`, '--no-first-run', '--disable-extensions',
        `http://127.0.0.1:${server.address().port}/`], { stdio: 'ignore' });
    browser.on('error', (error) => { console.error(String(error)); end(1); });
    setTimeout(() => { console.error('no answer within five minutes'); end(1); }, 300_000).unref();
});
