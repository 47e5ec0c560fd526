% The rest is the same for every protocol; its numbers are at the end of this file.
if nargin < 1
  device = 'Dev1';
end
p = numbers();
folder = fileparts(mfilename('fullpath'));
wave = dlmread(fullfile(folder, 'waveform.csv'), ',', 1, 0); % time (s), V (kV), control (V)
control = wave(:, 3);
rounded = 1e-9 * (p.highest_V - p.lowest_V);
if ~all(control >= p.lowest_V - rounded & control <= p.highest_V + rounded) % NaN is not
  error('waveform.csv goes beyond the %g V to %g V of control voltage that were checked', ...
        p.lowest_V, p.highest_V);
end
if ~all(abs(wave(:, 2) - p.gain / 1000 * control) <= 1e-6 * max(abs(wave(:, 2))))
  error('the voltages in waveform.csv are not its control voltages times the gain');
end
if control(end) ~= 0
  error('waveform.csv does not end at 0 V');
end
name = fullfile(folder, 'recording.csv');
if exist(name, 'file')
  error('recording.csv already exists; rename it first');
end

d = daq('ni');
d.Rate = p.rate_Hz;
[module, terminal] = physical(device, p.output);
addoutput(d, module, terminal, 'Voltage');
for k = 1:numel(p.channels)
  [module, terminal] = physical(device, p.channels(k).terminal);
  input_k = addinput(d, module, terminal, 'Voltage');
  input_k.Range = p.channels(k).range * [-1 1];
end
if abs(d.Rate - p.rate_Hz) > 1e-7 * p.rate_Hz % that of the device's clock, divided
  error(['the device has no rate of %.12g Hz; write ''rate: %.12g Hz'' into the protocol and ', ...
         'export it again'], p.rate_Hz, d.Rate);
end

% Whatever happens from here on, Ctrl-C too, the output goes to 0 V.
state = containers.Map({'read', 'why'}, {0, ''}, 'UniformValues', false);
guard = onCleanup(@() ramp_to_zero(d, device, p, control, state));
file = fopen(name, 'w');
close_file = onCleanup(@() fclose(file));
fprintf(file, 'time (s),command (kV)');
fprintf(file, ',%s', p.channels.title);
fprintf(file, '\n');

preload(d, control);
start(d);
data = record(d, p, wave, state, file);
clear guard close_file % the output goes to 0 V, and the file is complete
save_recording(fullfile(folder, 'recording.mat'), p, wave, data);
if ~isempty(state('why'))
  error('ended after %g s: %s; the output was set to 0 V, not read back', ...
        size(data, 1) / p.rate_Hz, state('why'));
end
disp('recording.csv and recording.mat are complete. Next:  dea import recording.csv');
end

function data = record(d, p, wave, state, file)
% Reads until all was played, or a current stayed above its limit.
total = size(wave, 1);
block = max(1, floor(0.1 * p.rate_Hz));
data = zeros(total, numel(p.channels));
above = zeros(1, numel(p.channels));
while state('read') < total
  first = state('read') + 1;
  count = min(block, total - first + 1);
  rows = read(d, count, 'OutputFormat', 'Matrix');
  for k = 1:numel(p.channels)
    rows(:, k) = rows(:, k) * p.channels(k).scale + p.channels(k).offset;
  end
  last = first + count - 1;
  data(first:last, :) = rows;
  columns = [wave(first:last, 1:2), rows];
  form = [repmat('%.9g,', 1, size(columns, 2) - 1), '%.9g\n'];
  fprintf(file, form, columns');
  state('read') = last;
  for k = 1:numel(p.channels)
    for i = 1:count
      if abs(rows(i, k)) > p.channels(k).trip
        above(k) = above(k) + 1;
      else
        above(k) = 0;
      end
      if above(k) >= p.trip_samples
        state('why') = ['the current ''', p.channels(k).title, ''' was above its limit'];
        data = data(1:last, :);
        return
      end
    end
  end
end
end

function ramp_to_zero(d, device, p, control, state)
% From the voltage that the output may be left at to 0 V, by software; 0 V is written in any case.
% It went on a little after what was read: of 50 ms the sample nearest to 0 V counts, so that the way
% to 0 V never begins with a jump up.
count = state('read');
last = 0;
if count > 0
  tail = control(count:min(count + floor(0.05 * p.rate_Hz) + 1, numel(control)));
  [~, nearest] = min(abs(tail));
  last = tail(nearest);
end
try % one that does not stop is told 0 V, too
  stop(d);
catch
end
try
  delete(d); % which holds the output
catch
end
output = daq('ni');
[module, terminal] = physical(device, p.output);
addoutput(output, module, terminal, 'Voltage');
zero = onCleanup(@() write(output, 0));
began = tic;
left = abs(last);
speed = max(p.ramp_V_per_s / p.gain, left / p.longest_ramp_s);
while left > 0
  write(output, sign(last) * left);
  pause(0.002);
  left = abs(last) - speed * toc(began);
end
end

function save_recording(name, p, wave, data)
% One variable a channel, in SI units.
count = size(data, 1);
r = struct('time_s', wave(1:count, 1), 'command_V', 1000 * wave(1:count, 2));
for k = 1:numel(p.channels)
  r.(p.channels(k).variable) = data(:, k) * p.channels(k).unit;
end
if exist('OCTAVE_VERSION', 'builtin')
  save('-v7', name, '-struct', 'r');
else
  save(name, '-struct', 'r', '-v7.3');
end
end

function [module, terminal] = physical(device, name)
% 'Dev2/ai1' names its device itself.
at = find(name == '/', 1);
if isempty(at)
  module = device;
  terminal = name;
else
  module = name(1:at - 1);
  terminal = name(at + 1:end);
end
end

