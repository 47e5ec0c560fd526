% What the package dea promises, against the command's results.h5 in by_command and against itself.
% Run by test_octave_tutorial.sh, which sets source_folder.

function expect_error(identifier, part, f)
  try
    f();
  catch e
    assert(e.identifier, identifier);
    assert(~isempty(strfind(e.message, part)), e.message);
    return;
  end
  error('no error %s', identifier);
end

assert(~isempty(regexp(dea.version(), '^\d+\.\d+\.\d+$')));
models = dea.models();
of_3d = models(strcmp({models.name}, '3d'));
assert(of_3d.available && any(strcmp(of_3d.abilities, 'indent')));
assert(~any(strcmp(models(strcmp({models.name}, 'lumped')).abilities, 'indent')));
studies = dea.studies();
assert(any(strcmp({studies.name}, 'sweep')));

% designs: values, units, places
file = fullfile(source_folder, 'examples', 'frdea-4.yaml');
d = dea.Design(file);
t = d.get('film.thickness');
assert({t.text, t.unit, t.origin}, {'100 um', 'm', 'given'});
assert(t.si, 100e-6, -1e-15);
lines = strsplit(fileread(file), "\n", "CollapseDelimiters", false);
assert(lines{t.line}(t.column:t.column + 5), '100 um');
e = d.copy();
same = d;
d.set('film.thickness', '80 um', 'fibres.count', 6, 'compute.models', {'lumped'});
assert(same.get('film.thickness').text, '80 um');
assert(d.get('film.thickness').origin, 'set');
assert(e.get('film.thickness').text, '100 um');
assert(d.get('fibres.count').si, 6);
assert(dea.Design.parse(d.yaml()).get('film.thickness').si, 80e-6, -1e-15);
expect_error('dea:design', 'did you mean', @() d.set('film.thicknes', '80 um'));
expect_error('dea:design', 'has no unit', @() d.set('film.thickness', 80));
assert(d.get('film.thickness').text, '80 um');
expect_error('dea:design', 'it:2:19: error: thickness', ...
             @() dea.Design.parse(sprintf('dea: 1\nfilm: {thickness: 3 kV}\n'), 'it'));
found = dea.findings();
found = found(~cellfun(@isempty, strfind({found.text}, '3 kV')));
assert({found.severity, found.file, found.line, found.column}, {'error', 'it', 2, 19});
expect_error('dea:io', 'nowhere.yaml', @() dea.Design('nowhere.yaml'));
expect_error('dea:argument', 'no.such', @() d.get('no.such'));
expect_error('dea:argument', 'no such option', @() dea.run(d, 'colour', 'red'));
assert(any(strfind(d.svg(), '<svg')));

% results: the same numbers as the command's
e.set('compute.voltage', '{from: 0 kV, to: 4 kV, step: 0.5 kV}');
r = dea.run(e, 'models', 'lumped', 'progress', false);
p = r.table('lumped/sweep');
assert(any(strcmp(r.curves(), 'lumped/path')));
x = load('by_command/results.h5').curves.lumped;
keys = setdiff(fieldnames(x.sweep), 'events');
assert(sort(fieldnames(p)), sort(keys));
for i = 1:numel(keys)
  assert(p.(keys{i}), double(x.sweep.(keys{i})(:)));
end
[z, unit, meaning] = r.array('lumped/path/centre_z_m');
assert(z, x.path.centre_z_m(:));
assert(unit, 'm');
assert(any(strfind(meaning, 'centre')));
old = dea.Result('by_command');
assert(old.table('lumped/path'), r.table('lumped/path'));
assert(r.text('lumped/sweep/status'), 'DEA_OK');
assert(r.design().get('compute.voltage.to').si, 4000);
expect_error('dea:argument', 'nothing', @() r.array('nothing'));
expect_error('dea:argument', 'nothing', @() r.table('nothing'));
r.save('saved.h5');
r.write('written', 'figures', false);
expect_error('dea:io', 'written', @() r.write('written', 'figures', false));
saved = dea.Result('saved.h5');
written = dea.Result('written');
assert(saved.table('lumped/sweep'), p);
assert(written.table('lumped/sweep'), p);
assert(~isempty(strfind(r.figure('stretch'), '<svg')));
a = dea.Actuator(e, 'lumped');
a.solve(2000);
assert(a.get('electrode_stretch'), p.electrode_stretch(p.voltage_V == 2000), 1e-9);
expect_error('dea:unsupported', 'indent', @() a.indent(1e-4, 1e-3));
expect_error('dea:argument', 'cube', @() a.indent(1e-4, 1e-3, 'cube'));

% meshes: a plane film of that area, nodes counted from 1; fields of points and of cells
e.set('compute.solid.film', 'membrane', 'compute.voltage', ...
      '{from: 0 kV, to: 1 kV, step: 1 kV}');
r = dea.run(e, 'models', '3d', 'studies', 'sweep', 'progress', false);
assert(r.meshes(), {'3d/surface/0000', '3d/surface/0001'});
part = r.mesh('3d/surface/0001', false);
whole = r.mesh('3d/surface/0001');
assert(whole.voltage_V, 1000);
assert(size(whole.points, 1), 2 * part.fold * size(part.points, 1));
area = 0;
f = dea.faces(whole);
for i = 1:2 % two triangles
  corners = f(:, [1, i + 1, i + 2]);
  X = whole.points(:, 1)(corners);
  Y = whole.points(:, 2)(corners);
  area = area + sum(abs((X(:, 2) - X(:, 1)) .* (Y(:, 3) - Y(:, 1)) ...
                        - (X(:, 3) - X(:, 1)) .* (Y(:, 2) - Y(:, 1)))) / 2;
end
assert(area, pi * 15e-3^2, -0.01); % a polygon in the circle
assert(max(f(:)), size(whole.points, 1));
assert(min(f(:)), 1);
u = whole.fields.displacement_m;
assert(size(u), size(whole.points));
[~, centre] = min(sum(whole.points.^2, 2));
assert(u(centre, 3), r.table('3d/sweep').centre_z_m(2), 1e-12);
cells = sum(cellfun(@rows, {whole.cells.nodes}));
about = struct2cell(whole.about);
of_cells = cellfun(@(one) one.of_cells, about);
assert(any(of_cells));
values = struct2cell(whole.fields);
assert(all(cellfun(@rows, values(of_cells)) == cells));

% what was freed, and numbers that are none
id = a.id;
clear a;
expect_error('dea:argument', 'no longer', @() dea_mex('actuator_get', id, 'centre_z_m'));
expect_error('dea:argument', 'no longer', @() dea_mex('design_yaml', r.id));
expect_error('dea:argument', 'arguments', @() dea_mex('design_yaml'));
